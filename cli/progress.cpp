#include "cli/progress.h"

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <string>
#include <string_view>

#include "app/exit_code.h"

#ifdef _WIN32
#include <io.h>
#include <process.h>
#define XRDS_IS_TERMINAL (_isatty(2) != 0)
#define XRDS_WRITE _write
#else
#include <unistd.h>
#define XRDS_IS_TERMINAL (isatty(2) != 0)
#define XRDS_WRITE write
#endif

namespace xrds {
namespace {

volatile std::sig_atomic_t interruptFlag = 0, endsAtOnce = 0;
bool onTerminal = false;

#define XRDS_INTERRUPTED "Interrupted; no unfinished file is left behind."

// What a signal handler may call. There is nobody left to tell that it failed.
void writeError(std::string_view text) {
  if (XRDS_WRITE(2, text.data(), static_cast<unsigned>(text.size())) < 0) return;
}

void setInterrupted(int) {
  interruptFlag = 1;
  if (endsAtOnce == 0) return;
  constexpr std::string_view kErase = "\r\033[K", kMessage = "xrds: " XRDS_INTERRUPTED "\n";
  if (onTerminal) writeError(kErase);
  writeError(kMessage);
  _exit(static_cast<int>(ExitCode::interrupted));
}

}  // namespace

ProgressStyle progressStyle(bool quiet) {
  return quiet ? ProgressStyle::none : XRDS_IS_TERMINAL ? ProgressStyle::bar : ProgressStyle::lines;
}

void catchInterrupts() {
  onTerminal = XRDS_IS_TERMINAL;
  std::signal(SIGINT, setInterrupted);
  std::signal(SIGTERM, setInterrupted);
#ifdef SIGHUP
  if (std::signal(SIGHUP, setInterrupted) == SIG_IGN) std::signal(SIGHUP, SIG_IGN);  // as nohup wants it
#endif
#ifdef SIGXFSZ
  std::signal(SIGXFSZ, SIG_IGN);
#endif
}

bool interrupted() { return interruptFlag != 0; }

void stopIfInterrupted() {
  if (interrupted()) throw Failure{ExitCode::interrupted, XRDS_INTERRUPTED};
}

EndsAtOnce::EndsAtOnce() {
  std::fflush(stdout);  // what was printed before is not lost
  endsAtOnce = 1;
  if (!interrupted()) return;
  endsAtOnce = 0;
  stopIfInterrupted();
}

EndsAtOnce::~EndsAtOnce() { endsAtOnce = 0; }

PreparationLine::PreparationLine(bool quiet) : style_(progressStyle(quiet)) {}

bool PreparationLine::update(const Preparation& preparation) {
  constexpr double kSecondsBetween = 2;
  const bool compiles = preparation.phase == Preparation::Phase::machineCode;
  const double seconds = timer_.seconds();
  const int tenth = static_cast<int>(10 * preparation.done / std::max<size_t>(preparation.total, 1));
  if (preparation.phase != phase_) lastTenth_ = -1;
  phase_ = preparation.phase;
  const std::string text = std::string(compiles ? "xrds: compiling programs for this device, kept for the next start: "
                                                : "xrds: preparing programs: ") +
                           std::to_string(preparation.done) + " of " + std::to_string(preparation.total);
  if (style_ == ProgressStyle::bar) {
    const bool ended = preparation.done == preparation.total;
    std::fprintf(stderr, "\r%s\033[K", ended ? "" : text.c_str());
    std::fflush(stderr);
  } else if (style_ == ProgressStyle::lines && tenth > lastTenth_ && seconds > nextLine_) {
    lastTenth_ = tenth;
    nextLine_ = seconds + kSecondsBetween;
    std::fprintf(stderr, "%s\n", text.c_str());
  }
  return !interrupted();
}

ProgressBar::ProgressBar(bool quiet) : style_(progressStyle(quiet)) { update(0); }

ProgressBar::~ProgressBar() {
  if (style_ == ProgressStyle::bar) std::fprintf(stderr, "\r\033[K");
}

bool ProgressBar::update(double share) {
  const double seconds = timer_.seconds();
  const std::string left = share > 0 ? std::to_string(std::lround(seconds * (1 - share) / share)) + " s left" : "";
  if (style_ == ProgressStyle::bar) {
    constexpr int kWidth = 30;
    const std::string done(static_cast<size_t>(share * kWidth), '#');
    std::fprintf(stderr, "\r[%-*s] %3.0f %%  %s\033[K", kWidth, done.c_str(), 100 * share, left.c_str());
    std::fflush(stderr);
  } else if (style_ == ProgressStyle::lines && static_cast<int>(10 * share) > lastTenth_ && seconds > 2) {
    lastTenth_ = static_cast<int>(10 * share);
    std::fprintf(stderr, "%.0f %% done, %s\n", 100 * share, left.c_str());
  }
  return !interrupted();
}

}  // namespace xrds
