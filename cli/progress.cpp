#include "cli/progress.h"

#include <cmath>
#include <csignal>
#include <cstdio>
#include <string>

#include "app/exit_code.h"

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

void stopIfInterrupted() {
  if (interrupted()) throw Failure{ExitCode::interrupted, "Interrupted; no unfinished file is left behind."};
}

ProgressBar::ProgressBar(bool quiet) : style_(quiet ? Style::none : XRDS_IS_TERMINAL ? Style::bar : Style::lines) {
  update(0);
}

ProgressBar::~ProgressBar() {
  if (style_ == Style::bar) std::fprintf(stderr, "\r\033[K");
}

bool ProgressBar::update(double share) {
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  const std::string left = share > 0 ? std::to_string(std::lround(seconds * (1 - share) / share)) + " s left" : "";
  if (style_ == Style::bar) {
    constexpr int kWidth = 30;
    const std::string done(static_cast<size_t>(share * kWidth), '#');
    std::fprintf(stderr, "\r[%-*s] %3.0f %%  %s\033[K", kWidth, done.c_str(), 100 * share, left.c_str());
    std::fflush(stderr);
  } else if (style_ == Style::lines && static_cast<int>(10 * share) > lastTenth_ && seconds > 2) {
    lastTenth_ = static_cast<int>(10 * share);
    std::fprintf(stderr, "%.0f %% done, %s\n", 100 * share, left.c_str());
  }
  return !interrupted();
}

}  // namespace xrds
