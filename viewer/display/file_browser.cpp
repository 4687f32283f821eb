#include "viewer/display/file_browser.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <algorithm>
#include <cctype>
#include <utility>

#include "sequence/file_pattern.h"
#include "xrds/path_text.h"

namespace xrds {
namespace fs = std::filesystem;

namespace {

std::string lowered(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

bool comesBefore(const FileBrowser::Entry& a, const FileBrowser::Entry& b) {
  if (a.isFolder != b.isFolder) return a.isFolder;
  const std::string lowA = lowered(a.name), lowB = lowered(b.name);
  return lowA != lowB ? lowA < lowB : a.name < b.name;
}

}  // namespace

void FileBrowser::open() {
  std::error_code error;
  if (folder_.empty()) folder_ = fs::current_path(error);
  list("");
  isOpen_ = true;
}

// Places the cursor at the entry of that name, else at the first.
void FileBrowser::list(const std::string& under) {
  entries_.clear();
  cursor_ = 0;
  moved_ = true;
  std::error_code error;
  for (fs::directory_iterator at(folder_, error), end; !error && at != end; at.increment(error)) {
    Entry entry{at->path().filename().string()};
    std::error_code broken;  // a link to nowhere, say
    entry.isFolder = at->is_directory(broken);
    const bool isImage = hasExtension(at->path(), ".exr") && at->is_regular_file(broken);
    if (entry.name.starts_with('.') || !(entry.isFolder || isImage)) continue;
    if (isImage) entry.byteSize = at->file_size(broken);
    entries_.push_back(std::move(entry));
  }
  failure_ = error ? "This folder cannot be listed: " + error.message() + "." : "";
  std::sort(entries_.begin(), entries_.end(), comesBefore);
  const auto found = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& e) { return e.name == under; });
  if (found != entries_.end()) cursor_ = static_cast<size_t>(found - entries_.begin());
}

void FileBrowser::go(const fs::path& path) {
  std::error_code error;
  fs::path whole = fs::absolute(path.is_absolute() ? path : folder_ / path, error).lexically_normal();
  if (!whole.has_filename() && whole.has_relative_path()) whole = whole.parent_path();  // "a/" is "a"
  if (fs::is_regular_file(whole, error)) {
    folder_ = whole.parent_path();
    return finish({whole.string()});
  }
  folder_ = whole;
  list("");
}

void FileBrowser::goUp() {
  const std::string from = folder_.filename().string();
  folder_ = folder_.parent_path();
  list(from);
}

void FileBrowser::moveTo(size_t entry) {
  if (!entries_.empty()) cursor_ = std::min(entry, entries_.size() - 1);
}

void FileBrowser::move(int steps) {
  const auto wanted = static_cast<ptrdiff_t>(cursor_) + steps;
  moveTo(static_cast<size_t>(std::max<ptrdiff_t>(0, wanted)));
  moved_ = true;
}

void FileBrowser::toggle() {
  if (entries_.empty() || entries_[cursor_].isFolder) return;
  entries_[cursor_].chosen = !entries_[cursor_].chosen;
}

void FileBrowser::accept() {
  std::vector<std::string> files;
  for (const Entry& entry : entries_)
    if (entry.chosen) files.push_back((folder_ / pathOf(entry.name)).string());
  if (!files.empty()) return finish(files);
  if (entries_.empty()) return;
  const Entry entry = entries_[cursor_];
  if (entry.isFolder) return go(folder_ / pathOf(entry.name));
  finish({(folder_ / pathOf(entry.name)).string()});
}

void FileBrowser::takeFolder() { finish({folder_.string()}); }

void FileBrowser::finish(const std::vector<std::string>& files) {
  close();
  take_(files);
}

void FileBrowser::jumpTo(char letter) {
  for (size_t step = 1; step <= entries_.size(); ++step) {
    const size_t entry = (cursor_ + step) % entries_.size();
    if (lowered(entries_[entry].name).front() != letter) continue;
    cursor_ = entry;
    moved_ = true;
    return;
  }
}

void FileBrowser::pressKey(int key, int modifiers) {
  constexpr int kPage = 10;
  switch (key) {
    case GLFW_KEY_UP:
      return move(-1);
    case GLFW_KEY_DOWN:
      return move(1);
    case GLFW_KEY_PAGE_UP:
      return move(-kPage);
    case GLFW_KEY_PAGE_DOWN:
      return move(kPage);
    case GLFW_KEY_HOME:
      return move(-static_cast<int>(entries_.size()));
    case GLFW_KEY_END:
      return move(static_cast<int>(entries_.size()));
    case GLFW_KEY_SPACE:
      toggle();
      return move(1);
    case GLFW_KEY_ENTER:
    case GLFW_KEY_KP_ENTER:
      return (modifiers & GLFW_MOD_CONTROL) != 0 ? takeFolder() : accept();
    case GLFW_KEY_BACKSPACE:
    case GLFW_KEY_LEFT:
      return goUp();
    case GLFW_KEY_ESCAPE:
      return close();
    default:
      break;
  }
  const bool letter = (key >= GLFW_KEY_A && key <= GLFW_KEY_Z) || (key >= GLFW_KEY_0 && key <= GLFW_KEY_9);
  if (letter && modifiers == 0) jumpTo(static_cast<char>(std::tolower(key)));
}

bool FileBrowser::takeMoved() { return std::exchange(moved_, false); }

}  // namespace xrds
