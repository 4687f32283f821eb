#include "cli/progress.h"

#include <csignal>
#include <cstdio>
#include <string>

#ifdef _WIN32
#include <io.h>
#define XRDS_IS_TERMINAL (_isatty(2) != 0)
#else
#include <unistd.h>
#define XRDS_IS_TERMINAL (isatty(2) != 0)
#endif

namespace xrds {
namespace {

volatile std::sig_atomic_t interruptFlag = 0;
void setInterrupted(int) { interruptFlag = 1; }

}  // namespace

void catchInterrupts() {
  std::signal(SIGINT, setInterrupted);
  std::signal(SIGTERM, setInterrupted);
}

bool interrupted() { return interruptFlag != 0; }

ProgressBar::ProgressBar(bool quiet) : style_(quiet ? Style::none : XRDS_IS_TERMINAL ? Style::bar : Style::lines) {}

ProgressBar::~ProgressBar() {
  if (style_ == Style::bar) std::fprintf(stderr, "\r\033[K");
}

bool ProgressBar::update(double share) {
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  const double left = share > 0 ? seconds * (1 - share) / share : 0;
  if (style_ == Style::bar) {
    constexpr int kWidth = 30;
    const std::string done(static_cast<size_t>(share * kWidth), '#');
    std::fprintf(stderr, "\r[%-*s] %3.0f %%  %.0f s left \033[K", kWidth, done.c_str(), 100 * share, left);
    std::fflush(stderr);
  } else if (style_ == Style::lines && static_cast<int>(10 * share) > lastTenth_ && seconds > 2) {
    lastTenth_ = static_cast<int>(10 * share);
    std::fprintf(stderr, "%d %% done, %.0f s left\n", static_cast<int>(100 * share), left);
  }
  return !interrupted();
}

}  // namespace xrds
