#include "viewer/watch.h"

namespace xrds {

bool FileWatch::changed(const std::vector<std::filesystem::path>& files, std::chrono::steady_clock::time_point now) {
  constexpr auto kStill = std::chrono::milliseconds(80);
  std::vector<State> states;
  for (const auto& file : files) {
    std::error_code error;
    State state{std::filesystem::last_write_time(file, error), std::filesystem::file_size(file, error)};
    if (error) return false;
    states.push_back(state);
  }
  if (files != files_) taken_.clear();
  if (files != files_ || states != seen_) {
    files_ = files;
    seen_ = std::move(states);
    since_ = now;
    return false;
  }
  if (seen_ == taken_ || now - since_ < kStill) return false;
  taken_ = seen_;
  return true;
}

}  // namespace xrds
