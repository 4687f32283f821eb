#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace xrds {

/// A folder's contents, from which EXR files are chosen with keyboard or mouse: what the dialog shows, without how.
class FileBrowser {
 public:
  struct Entry {
    std::string name;
    bool isFolder = false, chosen = false;
    uint64_t byteSize = 0;
  };

  /// `take` is called with what was chosen, files or one folder to watch, when the dialog has closed.
  explicit FileBrowser(std::function<void(const std::vector<std::string>&)> take) : take_(std::move(take)) {}

  bool isOpen() const { return isOpen_; }
  /// Shows the folder that was shown last, at first the current one.
  void open();
  void close() { isOpen_ = false; }

  const std::filesystem::path& folder() const { return folder_; }
  /// Folders, then EXR files, each in alphabetical order; hidden ones are left out.
  const std::vector<Entry>& entries() const { return entries_; }
  size_t cursor() const { return cursor_; }
  /// Why the folder cannot be listed; empty if it was.
  const std::string& failure() const { return failure_; }

  /// Shows another folder; of a file, takes it.
  void go(const std::filesystem::path& path);
  void goUp();
  void moveTo(size_t entry);
  void move(int steps);
  /// Chooses the file at the cursor, or no longer.
  void toggle();
  /// Enters the folder at the cursor, or takes the files that are chosen, else the one at the cursor.
  void accept();
  void takeFolder();
  /// What keys do while the dialog is open; as GLFW numbers them.
  void pressKey(int key, int modifiers);
  /// Whether the cursor was moved by a key since this was asked last.
  bool takeMoved();

 private:
  void list(const std::string& under);
  void finish(const std::vector<std::string>& files);
  void jumpTo(char letter);

  std::function<void(const std::vector<std::string>&)> take_;
  std::filesystem::path folder_;
  std::vector<Entry> entries_;
  std::string failure_;
  size_t cursor_ = 0;
  bool isOpen_ = false, moved_ = false;
};

}  // namespace xrds
