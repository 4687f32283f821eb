// Greps every include of our own headers against the table of rooms: who may include whom.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>

namespace {

namespace fs = std::filesystem;
const fs::path kSource = XRDS_SOURCE_FOLDER;

// Room of the including file -> first path components it may include, besides its own room.
const std::map<std::string, std::set<std::string>> kAllowed = {
    {"engine", {"volk.h", "vulkan", "xrds"}},
    {"shaders", {"engine"}},
    {"graph", {"engine", "shaders"}},
    {"network", {"engine", "shaders", "graph", "xrds"}},
    {"frames", {"engine", "shaders", "graph", "network", "xrds"}},
    {"checks", {"engine", "shaders", "graph", "network", "frames", "image", "xrds"}},
    {"tuning", {"engine", "shaders", "graph", "network", "frames", "checks", "xrds"}},
    {"api", {"engine", "shaders", "graph", "network", "frames", "checks", "tuning", "image", "xrds"}},
    {"image", {"xrds"}},
    {"include", {"xrds", "vulkan"}},
    {"advice", {"xrds", "image"}},
    {"sequence", {"xrds"}},
    {"app", {"xrds", "image"}},
    {"cli", {"xrds", "image", "app", "advice", "sequence"}},
    {"viewer", {"xrds", "image", "app", "sequence", "vulkan", "GLFW"}},
    {"bench", {"engine", "shaders", "graph", "network", "frames", "checks", "image", "xrds"}},
    {"fuzz", {"network", "image", "xrds"}},
    {"python", {"xrds"}},
};
const std::set<std::string> kRooms{"engine", "shaders", "graph", "network",  "frames",   "checks", "tuning",
                                   "api",    "image",   "app",   "advice",   "sequence", "cli",    "viewer",
                                   "bench",  "fuzz",    "tests", "training", "python"};
const std::set<std::string> kForeign{"volk.h", "vulkan", "GLFW", "xrds"};  // watched, though not rooms
// What rooms without Vulkan may take from others: values, what is made of them alone, and files.
const std::set<std::string> kValueHeaders{"engine/tensor.h", "engine/device_traits.h", "engine/dispatch.h",
                                          "engine/check.h",  "engine/half.h",          "engine/work.h",
                                          "engine/bytes.h",  "engine/replace_file.h"};
const std::set<std::string> kImageHeaders{"image/repair.h", "image/image.h"};
const std::map<std::string, std::map<std::string, std::set<std::string>>> kHeaders = {
    {"shaders", {{"engine", kValueHeaders}}}, {"graph", {{"engine", kValueHeaders}}},
    {"network", {{"engine", kValueHeaders}}}, {"checks", {{"image", kImageHeaders}}},
    {"api", {{"image", kImageHeaders}}},
};

std::vector<std::string> includesOf(const fs::path& file) {
  static const std::regex pattern(R"(^\s*#\s*include\s*[<"]([^>"]+)[>"])");
  std::vector<std::string> found;
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);)
    if (std::smatch match; std::regex_search(line, match, pattern)) found.push_back(match[1]);
  return found;
}

TEST(IncludeDirections, FollowTheTableOfRooms) {
  size_t checked = 0;
  for (const auto& [room, allowed] : kAllowed) {
    ASSERT_TRUE(fs::exists(kSource / room)) << room;
    for (const auto& entry : fs::recursive_directory_iterator(kSource / room)) {
      const std::string extension = entry.path().extension().string(), name = entry.path().filename().string();
      const bool source = extension == ".h" || extension == ".cpp" || extension == ".comp" || extension == ".glsl";
      if (!source || name.ends_with("_test.cpp")) continue;
      for (const std::string& include : includesOf(entry.path())) {
        const std::string first = include.substr(0, include.find('/'));
        if (!kRooms.contains(first) && !kForeign.contains(first)) continue;
        ++checked;
        EXPECT_TRUE(first == room || allowed.contains(first)) << entry.path() << " includes " << include;
        const auto narrowed = kHeaders.find(room);
        if (narrowed == kHeaders.end() || !narrowed->second.contains(first)) continue;
        EXPECT_TRUE(narrowed->second.at(first).contains(include)) << entry.path() << " includes " << include;
      }
    }
  }
  EXPECT_GT(checked, 50u);
}

// One operator's room does not look into another's.
TEST(IncludeDirections, OperatorsKeepToThemselves) {
  for (const auto& entry : fs::recursive_directory_iterator(kSource / "shaders")) {
    const std::string own = fs::relative(entry.path(), kSource / "shaders").begin()->string();
    if (!entry.is_regular_file() || own == "CMakeLists.txt") continue;
    for (const std::string& include : includesOf(entry.path())) {
      if (!include.starts_with("shaders/")) continue;
      const std::string other = include.substr(8, include.find('/', 8) - 8);
      EXPECT_TRUE(other == own || other == "common" || other == "programs.h")
          << entry.path() << " includes " << include;
    }
  }
}

}  // namespace
