#include "frames/history_merger.h"

#include <algorithm>

#include "engine/bytes.h"

namespace xrds {
namespace {

constexpr uint32_t kRadius = 2;  // of merge_history

}  // namespace

HistoryMerger::HistoryMerger(Gpu& gpu, uint32_t height, uint32_t width, uint32_t scale)
    : gpu_(gpu), height_(height), width_(width), scale_(scale) {
  low_ = create("low", 1, shader::kHistoryFrame);
  full_ = create("full", scale, shader::kHistoryFrame);
  historyLow_ = create("history low", 1, shader::kHistoryFrame);
  historyFull_ = create("history full", scale, shader::kHistoryFrame);
  motion_ = create("motion", scale, 4);
  exposure_ = graph_.create("exposure", DataType::f32, {1, 1, 4});
  buffers_.push_back(std::make_unique<Buffer>(gpu_, kBindingAlignment));
  lowPositions_ = create("low positions", 1, 4);
  warpedLow_ = create("warped low", 1, shader::kHistoryWarped);
  warpedFull_ = create("warped full", scale, shader::kHistoryWarped);
  lowGuides_ = create("low guides", 1, 4);
  resultLow_ = create("result low", 1, 4);
  for (int i = 0; i < 2; ++i) {
    positions_[i] = create("positions", scale, 4);
    sumsLow_[i] = create("sums low", 1, shader::kHistoryFrame);
    sumsFull_[i] = create("sums full", scale, shader::kHistoryFrame);
  }
  resultFull_ = historyFull_;  // which is of no more use then
  prepare_ = record({BoxMean{slice(full_, 4, 8), slice(low_, 4, 8), scale_}, Exposure{slice(low_, 0, 4), exposure_}});
}

TensorView HistoryMerger::create(const char* name, uint32_t scale, uint32_t channels) {
  const TensorView view = graph_.create(name, DataType::f32, {scale * height_, scale * width_, channels});
  buffers_.push_back(std::make_unique<Buffer>(gpu_, alignUp(view.storedByteSize(), kBindingAlignment)));
  return view;
}

Recording HistoryMerger::record(std::vector<Operator> operators) {
  Graph graph = graph_;
  for (Operator& op : operators) {
    graph.nodes.push_back({"", std::move(op)});
    graph.nodes.back().name = factsOf(graph.nodes.back()).name;
  }
  std::vector<PlacedDispatch> placed;
  for (LoweredDispatch& lowered : lower(graph, gpu_.traits())) {
    PlacedDispatch& dispatch = placed.emplace_back(PlacedDispatch{std::move(lowered.dispatch), {}});
    for (const Binding& binding : dispatch.dispatch.bindings)
      dispatch.ranges.push_back({buffers_[binding.value].get(), binding.byteOffset, binding.byteSize});
  }
  return {gpu_, placed};
}

void HistoryMerger::upload(const TensorView& view, std::span<const float> values) {
  XRDS_CHECK_EQ(values.size(), view.storedElementCount());
  buffers_[view.value]->upload(0, std::as_bytes(values));
}

void HistoryMerger::download(const TensorView& view, std::span<float> values) const {
  XRDS_CHECK_EQ(values.size(), view.storedElementCount());
  buffers_[view.value]->download(0, std::as_writable_bytes(values));
}

void HistoryMerger::mergeStep(bool first) {
  inChain_ = first ? 0 : inChain_ + 1;
  const uint32_t position = inChain_ % 2, sum = merged_ % 2;
  const std::pair key{first ? 2 : position, merged_ == 0 ? 2 : sum};
  auto found = steps_.find(key);
  if (found == steps_.end()) {
    const TensorView from = first ? TensorView{} : positions_[1 - position], to = positions_[position];
    const auto before = [&](const TensorView(&sums)[2]) { return merged_ == 0 ? TensorView{} : sums[1 - sum]; };
    Recording made = record({FollowMotion{from, motion_, to}, BoxMean{to, lowPositions_, scale_},
                             BoxMean{slice(historyFull_, 4, 8), slice(historyLow_, 4, 8), scale_},
                             WarpHistory{to, historyFull_, full_, exposure_, warpedFull_, 1},
                             WarpHistory{lowPositions_, historyLow_, low_, exposure_, warpedLow_, scale_},
                             MergeHistory{warpedFull_, full_, before(sumsFull_), sumsFull_[sum], kRadius},
                             MergeHistory{warpedLow_, low_, before(sumsLow_), sumsLow_[sum], kRadius}});
    found = steps_.emplace(key, std::move(made)).first;
  }
  found->second.run();
  ++merged_;
}

void HistoryMerger::mergeChain(const PackedFrame& present, std::span<const PackedFrame* const> chain, Motion motion) {
  const PackedFrame* last = &present;
  for (const PackedFrame* frame : chain) {
    if ((last->*motion).empty()) return;
    upload(motion_, last->*motion);
    upload(historyLow_, frame->low);
    upload(historyFull_, frame->full);
    mergeStep(last == &present);
    last = frame;
  }
}

void HistoryMerger::finish() {
  const uint32_t sum = (merged_ - 1) % 2;
  if (!finish_[sum])
    finish_[sum] =
        record({ResolveHistory{sumsFull_[sum], {}, resultFull_}, BoxMean{slice(resultFull_, 4, 4), lowGuides_, scale_},
                ResolveHistory{sumsLow_[sum], lowGuides_, resultLow_}});
  finish_[sum]->run();
}

void HistoryMerger::run(const PackedFrame& present, std::span<const PackedFrame* const> before,
                        std::span<const PackedFrame* const> after, std::span<float> low, std::span<float> full) {
  merged_ = 0;
  upload(low_, present.low);
  upload(full_, present.full);
  prepare_->run();
  mergeChain(present, before, &PackedFrame::toPrevious);
  mergeChain(present, after, &PackedFrame::toNext);
  if (merged_ > 0) {
    finish();
    download(resultLow_, low);
    download(resultFull_, full);
    return;
  }
  std::copy(present.full.begin(), present.full.end(), full.begin());
  for (size_t pixel = 0; pixel < low.size() / 4; ++pixel)
    std::copy_n(&present.low[shader::kHistoryFrame * pixel], 4, &low[4 * pixel]);
}

uint64_t HistoryMerger::deviceBytes() const {
  uint64_t bytes = 0;
  for (const auto& buffer : buffers_) bytes += buffer->byteSize();
  return bytes;
}

}  // namespace xrds
