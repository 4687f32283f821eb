#include "frames/history_merger.h"

#include <algorithm>

namespace xrds {
namespace {

constexpr uint32_t kRadius = 2, kGuideRadius = 1;  // of merge_history: for light, and where there is none

// Few bands cost little time, as each warps the rows around it again; many cost little memory.
uint32_t suitableBandRows(uint32_t height) {
  constexpr uint32_t kLeastRows = 64, kBands = 16;
  return std::max(kLeastRows, (height + kBands - 1) / kBands);
}

// The bands of an image that moves up from its topmost on, of one that moves down from the lowest on: none is written
// where one lies that is still to be read.
std::vector<RowRange> inOrder(std::vector<RowRange> bands, bool movesUp) {
  if (!movesUp) std::reverse(bands.begin(), bands.end());
  return bands;
}

}  // namespace

HistoryMerger::HistoryMerger(Gpu& gpu, uint32_t height, uint32_t width, uint32_t scale, uint32_t bandRows)
    : gpu_(gpu), height_(height), width_(width), scale_(scale), images_(gpu) {
  low_ = createLevel(1, bandRows);
  full_ = createLevel(scale, bandRows);
  low_.scale = scale;
  positions_ = createMoving("positions", {scale * height, scale * width, 4}, full_.bandRows);
  lowPositions_ = images_.create("low positions", {height, width, 4});
  lowGuides_ = images_.create("low guides", {height, width, 4});
  exposure_ = images_.create("exposure", {1, 1, 4});
  motion_ = inPlaceOf(full_.history, 4);  // followed before the history comes
  resultLow_ = inPlaceOf(low_.history, 4);
  resultFull_ = full_.history;
  prepare_ = record({BoxMean{slice(full_.present, 4, 8), slice(low_.present, 4, 8), scale_},
                     Exposure{slice(low_.present, 0, 4), exposure_}});
}

HistoryMerger::Moving HistoryMerger::createMoving(const char* name, TensorShape shape, uint32_t bandRows) {
  const uint32_t height = shape.height;
  shape.height += bandRows;
  const TensorView both = images_.create(name, shape);
  return {rowsOf(both, {0, height}), rowsOf(both, {bandRows, bandRows + height})};
}

HistoryMerger::Level HistoryMerger::createLevel(uint32_t scale, uint32_t bandRows) {
  Level level{.height = scale * height_};
  const uint32_t width = scale * width_;
  level.bandRows = std::min(level.height, bandRows ? bandRows : suitableBandRows(level.height));
  level.present = images_.create("present", {level.height, width, shader::kHistoryFrame});
  level.history = images_.create("history", {level.height, width, shader::kHistoryFrame});
  level.warped =
      images_.create("warped", {std::min(level.height, level.bandRows + 2 * kRadius), width, shader::kHistoryWarped});
  level.sums = createMoving("sums", {level.height, width, shader::kHistoryFrame}, level.bandRows);
  return level;
}

// In the memory of a view that is of no use at the same time.
TensorView HistoryMerger::inPlaceOf(const TensorView& view, uint32_t channels) const {
  TensorView other = view;
  other.channels = other.channelStride = channels;
  return other;
}

std::vector<RowRange> HistoryMerger::Level::bands() const {
  std::vector<RowRange> rows;
  for (uint32_t begin = 0; begin < height; begin += bandRows)
    rows.push_back({begin, std::min(begin + bandRows, height)});
  return rows;
}

// The whole image with those rows stored that a band beginning there needs.
TensorView HistoryMerger::Level::warpedRows(uint32_t first) const {
  return asRowsOf(warped, height, std::min(first, height - warped.height));
}

Recording HistoryMerger::record(std::vector<Operator> operators) {
  return {gpu_, images_.placed(std::move(operators))};
}

Recording& HistoryMerger::follow(uint32_t inChain) {
  const uint32_t key = inChain == 0 ? 0 : 2 - inChain % 2;
  const auto found = follow_.find(key);
  if (found != follow_.end()) return found->second;
  const TensorView from = inChain == 0 ? TensorView{} : positions_.at(inChain - 1), to = positions_.at(inChain);
  std::vector<Operator> operators;
  for (const RowRange rows : inOrder(full_.bands(), inChain % 2 == 0))
    operators.emplace_back(FollowMotion{from, motion_, to, rows});
  operators.emplace_back(BoxMean{to, lowPositions_, scale_});
  return follow_.emplace(key, record(std::move(operators))).first->second;
}

void HistoryMerger::addMerging(const Level& level, const TensorView& positions, uint32_t merged,
                               std::vector<Operator>& to) const {
  const TensorView before = merged == 0 ? TensorView{} : level.sums.at(merged - 1);
  for (const RowRange rows : inOrder(level.bands(), merged % 2 == 0)) {
    const RowRange around{rows.begin - std::min(rows.begin, kRadius), std::min(rows.end + kRadius, level.height)};
    const TensorView warped = level.warpedRows(around.begin);
    to.emplace_back(WarpHistory{positions, level.history, level.present, exposure_, warped, level.scale, around});
    to.emplace_back(MergeHistory{warped, level.present, before, level.sums.at(merged), level.radius, rows});
  }
}

Recording& HistoryMerger::merge(uint32_t inChain) {
  const std::tuple key{inChain % 2, merged_ == 0, merged_ % 2, full_.radius};
  const auto found = merging_.find(key);
  if (found != merging_.end()) return found->second;
  std::vector<Operator> operators{BoxMean{slice(full_.history, 4, 8), slice(low_.history, 4, 8), scale_}};
  addMerging(full_, positions_.at(inChain), merged_, operators);
  addMerging(low_, lowPositions_, merged_, operators);
  return merging_.emplace(key, record(std::move(operators))).first->second;
}

void HistoryMerger::mergeChain(const HistoryFrame& present, std::span<const HistoryFrame> chain, Motion motion) {
  const HistoryFrame* last = &present;
  uint32_t inChain = 0;
  for (const HistoryFrame& frame : chain) {
    if (!(last->*motion)) return;
    images_.upload(motion_, last->*motion);
    follow(inChain).run();
    images_.upload(low_.history, frame.low);
    images_.upload(full_.history, frame.full);
    merge(inChain).run();
    ++inChain;
    ++merged_;
    last = &frame;
  }
}

void HistoryMerger::finish() {
  const uint32_t last = merged_ - 1;
  if (!finish_[last % 2])
    finish_[last % 2] = record({ResolveHistory{full_.sums.at(last), {}, resultFull_},
                                BoxMean{slice(resultFull_, 4, 4), lowGuides_, scale_},
                                ResolveHistory{low_.sums.at(last), lowGuides_, resultLow_}});
  finish_[last % 2]->run();
}

void HistoryMerger::giveOwn(const HistoryFrame& present, const TakeRow& low, const TakeRow& full) const {
  std::vector<float> row(size_t{shader::kHistoryFrame} * scale_ * width_);
  for (uint32_t y = 0; y < full_.height; ++y) {
    present.full(y, row);
    full(y, row);
  }
  row.resize(size_t{shader::kHistoryFrame} * width_);
  std::vector<float> colour(size_t{4} * width_);
  for (uint32_t y = 0; y < height_; ++y) {
    present.low(y, row);
    for (uint32_t x = 0; x < width_; ++x) std::copy_n(&row[size_t{shader::kHistoryFrame} * x], 4, &colour[4 * x]);
    low(y, colour);
  }
}

void HistoryMerger::run(const HistoryFrame& present, std::span<const HistoryFrame> before,
                        std::span<const HistoryFrame> after, const TakeRow& low, const TakeRow& full) {
  merged_ = 0;
  full_.radius = present.hasFullColour ? kRadius : kGuideRadius;
  if (before.empty() && after.empty()) return giveOwn(present, low, full);
  images_.upload(low_.present, present.low);
  images_.upload(full_.present, present.full);
  prepare_->run();
  mergeChain(present, before, &HistoryFrame::toPrevious);
  mergeChain(present, after, &HistoryFrame::toNext);
  if (merged_ == 0) return giveOwn(present, low, full);
  finish();
  images_.download(resultLow_, low);
  images_.download(resultFull_, full);
}

}  // namespace xrds
