#include "cli/sequence_report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "app/failing_with.h"
#include "app/listed.h"
#include "cli/json_text.h"
#include "cli/output_file.h"
#include "cli/table.h"
#include "cli/warnings.h"
#include "sequence/frame_range.h"

namespace xrds {
namespace {

using Json = nlohmann::ordered_json;

std::string timeText(double seconds) {
  const auto whole = static_cast<long>(std::lround(seconds));
  if (whole < 120) return std::to_string(whole) + " s";
  if (whole < 7200) return std::to_string(whole / 60) + " min";
  return text("%.1f h", seconds / 3600);
}

Json jsonOf(const std::array<double, 3>& seconds) {
  Json json;
  for (size_t stage = 0; stage < seconds.size(); ++stage) json[kStageNames[stage]] = seconds[stage];
  return json;
}

std::string withoutDigits(std::string text) {
  std::erase_if(text, [](char letter) { return letter >= '0' && letter <= '9'; });
  return text;
}

const char* nameOf(Outcome::State state, ExitCode code) {
  if (code == ExitCode::interrupted) return "interrupted";
  return state == Outcome::State::done ? "done" : state == Outcome::State::skipped ? "there" : "failed";
}

}  // namespace

SequenceReport::SequenceReport(const UpscaleOptions& options, const SequencePlan& plan, const LineThreads& threads)
    : options_(options), plan_(plan), threads_(threads), style_(progressStyle(options.quiet)) {}

bool SequenceReport::add(const Outcome& outcome) {
  Row row{outcome, {}, ExitCode::ok};
  const int number = plan_.frames[outcome.index].number;
  if (outcome.state == Outcome::State::failed) {
    Failure failure = failureOf(outcome.error);
    row.code = failure.code;
    row.message = failure.message;
    row.outcome.error = nullptr;
    if (failure.code != ExitCode::interrupted) failed_.push_back(number);
    const bool mayLast = failure.code == ExitCode::device || failure.code == ExitCode::output;
    failuresInARow_ = mayLast ? failuresInARow_ + 1 : 0;
    if (failuresInARow_ == kFailuresInARow && !ended_) ended_ = std::move(failure);
  } else if (outcome.state == Outcome::State::done) {
    failuresInARow_ = 0;
    ++done_;
    for (size_t stage = 0; stage < seconds_.size(); ++stage) seconds_[stage] += outcome.seconds[stage];
  } else {
    ++skipped_;
  }
  show(row);
  rows_[outcome.index] = std::move(row);
  if (constexpr double kSecondsBetween = 5; whole_.seconds() > logged_ + kSecondsBetween) {
    logged_ = whole_.seconds();
    writeLog();
  }
  return !ended_ && !interrupted();
}

std::string SequenceReport::slowestStage() const {
  const std::array<size_t, 3> threads{threads_.readers, threads_.workers, threads_.writers};
  const auto share = [&](size_t stage) { return seconds_[stage] / static_cast<double>(threads[stage]); };
  size_t slowest = 0;
  for (size_t stage = 1; stage < threads.size(); ++stage)
    if (share(stage) > share(slowest)) slowest = stage;
  return std::string(kStageNames[slowest]) + text(" is the slowest stage, %.2f s a frame",
                                                  seconds_[slowest] / static_cast<double>(std::max<size_t>(done_, 1)));
}

std::string SequenceReport::progressText() const {
  const size_t all = plan_.frames.size(), ended = done_ + skipped_ + failed_.size();
  std::string line = std::to_string(ended) + " of " + std::to_string(all) + " frames (" +
                     std::to_string(100 * ended / std::max<size_t>(all, 1)) + " %)";
  if (!failed_.empty()) line += ", " + std::to_string(failed_.size()) + " failed";
  if (done_ > 0) {
    line += ", " + timeText(whole_.seconds() * static_cast<double>(all - ended) / static_cast<double>(done_)) + " left";
    line += ", " + slowestStage();
  }
  return line;
}

std::string SequenceReport::failureText(int number, const std::string& message) {
  const auto [first, isNew] = failures_.try_emplace(withoutDigits(message), number);
  const bool hasList = message.find('\n') != std::string::npos;
  return isNew || !hasList ? ": " + message : " as frame " + std::to_string(first->second) + " did.";
}

void SequenceReport::show(const Row& row) {
  const int number = plan_.frames[row.outcome.index].number;
  if (row.code != ExitCode::ok && row.code != ExitCode::interrupted)
    std::fprintf(stderr, "%sxrds: frame %d failed%s\n", style_ == ProgressStyle::bar ? "\r\033[K" : "", number,
                 failureText(number, row.message).c_str());
  if (style_ == ProgressStyle::bar) {
    std::fprintf(stderr, "\r%s\033[K", progressText().c_str());
  } else if (style_ == ProgressStyle::lines) {
    std::fprintf(stderr, "frame %d %s; %s\n", number, nameOf(row.outcome.state, row.code), progressText().c_str());
  }
  std::fflush(stderr);
}

void SequenceReport::warn(int frame, const std::vector<std::string>& warnings) {
  for (const std::string& warning : warnings) {
    Alike& alike = warnings_[withoutDigits(warning)];
    if (alike.frames.empty()) {
      alike.first = "frame " + std::to_string(frame) + ": " + warning;
      printWarnings({alike.first});
    }
    alike.frames.insert(frame);
  }
}

void SequenceReport::printAlike() const {
  for (const auto& [kind, alike] : warnings_) {
    if (alike.frames.size() < 2) continue;
    const std::vector<int> frames(alike.frames.begin(), alike.frames.end());
    printWarnings(
        {"frames " + describeFrames(frames) + " had this warning, or one with other numbers: " + alike.first});
  }
}

void SequenceReport::writeLog() const {
  if (options_.log.empty()) return;
  Json json{{"version", XRDS_VERSION}, {"output", plan_.output}};
  json["frames"] = {{"made", done_},
                    {"there", plan_.there.size() + skipped_},
                    {"failed", failed_.size()},
                    {"notReached", plan_.frames.size() - done_ - skipped_ - failed_.size()}};
  json["seconds"] = whole_.seconds();
  json["secondsOfStages"] = jsonOf(seconds_);
  json["threads"] = {{"readers", threads_.readers}, {"workers", threads_.workers}, {"writers", threads_.writers}};
  Json& rows = json["rows"] = Json::array();
  for (const auto& [index, row] : rows_) {
    const SequenceFrame& frame = plan_.frames[index];
    Json one{
        {"frame", frame.number}, {"output", frame.output.string()}, {"state", nameOf(row.outcome.state, row.code)}};
    if (row.code != ExitCode::ok) {
      one["stage"] = kStageNames[static_cast<size_t>(row.outcome.stage)];
      one["exitCode"] = static_cast<int>(row.code);
      one["message"] = row.message;
    }
    one["seconds"] = jsonOf(row.outcome.seconds);
    one["worker"] = row.outcome.worker;
    rows.push_back(std::move(one));
  }
  try {
    writeText(options_.log, textOf(json));
  } catch (const Error& error) {  // the frames matter more
    printWarnings({error.what()});
  }
}

void SequenceReport::finish() {
  if (style_ == ProgressStyle::bar) std::fprintf(stderr, "\r\033[K");
  writeLog();
  printAlike();
  if (!options_.quiet) {
    std::printf("%s: %s made in %s", plan_.output.c_str(), counted(done_, "frame").c_str(),
                timeText(whole_.seconds()).c_str());
    if (const size_t there = plan_.there.size() + skipped_; there > 0) std::printf(", %zu were there", there);
    if (done_ > 0) std::printf("; %s", slowestStage().c_str());
    std::printf("\n");
  }
  std::sort(failed_.begin(), failed_.end());
  const std::string list = failed_.empty() ? "" : "Frames that failed: " + describeFrames(failed_) + ".";
  if (ended_)
    throw Failure{ended_->code, list + " Ended after " + std::to_string(kFailuresInARow) +
                                    " failures in a row, the last: " + ended_->message};
  if (!failed_.empty() && !interrupted()) throw Failure{ExitCode::frames, list};
  stopIfInterrupted();
}

}  // namespace xrds
