#pragma once

#include <filesystem>

namespace xrds {

/// A file on its way: written under a temporary name in the folder of its final one and renamed when complete, so that
/// nobody ever sees half of it; a file that it replaces passes its permissions on. Dropped without `commit`, it removes
/// the temporary. Not for sharing between threads.
class PendingFile {
 public:
  /// Chooses the temporary name. Symbolic links are followed, also to a file that does not exist yet, so that a link
  /// stays a link. Throws Error when links go in circles, the folder does not exist or `path` names something that is
  /// no regular file.
  explicit PendingFile(const std::filesystem::path& path);
  ~PendingFile();
  PendingFile(const PendingFile&) = delete;
  PendingFile& operator=(const PendingFile&) = delete;

  /// Where to write; not created by this type.
  const std::filesystem::path& temporaryPath() const { return temporaryPath_; }

  /// Renames the finished temporary to the final name, replacing an older file. Call it once, after the file has been
  /// closed. Throws Error when the rename fails; the temporary is then removed.
  void commit();

 private:
  std::filesystem::path path_;
  std::filesystem::path temporaryPath_;
  bool committed_ = false;
};

/// Removes what killed processes left of such files in a folder: temporaries that nobody has written to for an hour.
void removeAbandonedFiles(const std::filesystem::path& folder);

}  // namespace xrds
