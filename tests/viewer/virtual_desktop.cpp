#include "tests/viewer/virtual_desktop.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <png.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdlib>

// Last: it defines names that others use.
#include <X11/Xatom.h>
#include <X11/Xlib.h>

namespace xrds::test {
namespace fs = std::filesystem;

VirtualDesktop::VirtualDesktop() {
  int number[2];
  if (pipe(number) != 0) throw std::runtime_error("no pipe");
  server_ = fork();
  if (server_ == 0) {
    close(number[0]);
    const int nowhere = open("/dev/null", O_WRONLY);
    dup2(nowhere, STDERR_FILENO);
    const std::string descriptor = std::to_string(number[1]);
    execl(XRDS_XVFB, "Xvfb", "-displayfd", descriptor.c_str(), "-screen", "0", "1280x960x24", "-nolisten", "tcp",
          "-noreset", nullptr);
    _exit(127);
  }
  close(number[1]);
  // The server writes its number and a line feed once it takes connections.
  for (char byte = 0; read(number[0], &byte, 1) == 1 && byte != '\n';) name_ += byte;
  close(number[0]);
  if (name_.empty()) throw std::runtime_error("Xvfb does not start");
  name_ = ":" + name_;
}

VirtualDesktop::~VirtualDesktop() {
  kill(server_, SIGTERM);
  waitpid(server_, nullptr, 0);
}

void VirtualDesktop::scale(double factor) const {
  Display* display = XOpenDisplay(name_.c_str());
  if (!display) throw std::runtime_error("no X server at " + name_);
  const std::string resources = "Xft.dpi: " + std::to_string(std::lround(96 * factor)) + "\n";
  XChangeProperty(display, DefaultRootWindow(display), XA_RESOURCE_MANAGER, XA_STRING, 8, PropModeReplace,
                  reinterpret_cast<const unsigned char*>(resources.data()), static_cast<int>(resources.size()));
  XCloseDisplay(display);
}

Ended runViewer(const VirtualDesktop& desktop, const TemporaryFolder& folder, const std::string& script,
                std::vector<std::string> arguments, const std::map<std::string, std::string>& environment) {
  writeBytes(folder / "script.txt", script);
  arguments.insert(arguments.begin(), {"view", "--validation", "--script", "script.txt"});
  StartOptions options{.environment = {{"DISPLAY", desktop.name()}, {"XDG_CONFIG_HOME", (folder / "config").string()}},
                       .folder = folder / ""};
  options.environment.insert(environment.begin(), environment.end());
  return runXrds(arguments, options);
}

Image readPng(const fs::path& file) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  if (!png_image_begin_read_from_file(&png, file.c_str())) throw std::runtime_error(file.string() + ": " + png.message);
  png.format = PNG_FORMAT_RGB;
  std::vector<png_byte> bytes(PNG_IMAGE_SIZE(png));
  if (!png_image_finish_read(&png, nullptr, bytes.data(), 0, nullptr))
    throw std::runtime_error(file.string() + ": " + png.message);
  Image image(static_cast<int>(png.width), static_cast<int>(png.height), 3);
  std::copy(bytes.begin(), bytes.end(), image.pixels.begin());
  return image;
}

void expectLikeStored(const fs::path& file, double tolerance) {
  const fs::path stored = fs::path(XRDS_EXPECTED_FOLDER) / file.filename();
  if (std::getenv("XRDS_UPDATE_EXPECTED")) {
    fs::copy_file(file, stored, fs::copy_options::overwrite_existing);
    return;
  }
  const Image found = readPng(file), expected = readPng(stored);
  ASSERT_EQ(found.width, expected.width) << file;
  ASSERT_EQ(found.height, expected.height) << file;
  size_t different = 0;
  for (size_t i = 0; i < found.pixels.size(); ++i)
    different += std::abs(found.pixels[i] - expected.pixels[i]) > tolerance;
  EXPECT_LE(different, found.pixels.size() / 500) << file << " differs from " << stored;
}

double meanDifference(const Image& a, const Image& b) {
  double sum = 0;
  for (size_t i = 0; i < a.pixels.size(); ++i) sum += std::abs(a.pixels[i] - b.pixels.at(i));
  return sum / static_cast<double>(a.pixels.size());
}

Image cropped(const Image& image, int x, int y, int width, int height) {
  Image part(width, height, image.channels);
  for (int row = 0; row < height; ++row)
    for (int column = 0; column < width; ++column)
      for (int c = 0; c < image.channels; ++c) part.at(column, row, c) = image.at(x + column, y + row, c);
  return part;
}

}  // namespace xrds::test
