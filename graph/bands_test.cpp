#include "graph/bands.h"

#include <gtest/gtest.h>

#include "graph/in_place.h"
#include "network/network.h"

namespace xrds {
namespace {

TEST(Sweep, MakesEveryRowOnceAndInOrder) {
  for (const uint32_t height : {16u, 47u, 64u})
    for (const uint64_t bandRows : {16u, 48u, 64u, kWholeFrame})
      for (const uint32_t distance : {0u, 8u, 40u}) {
        const Sweep sweep{height, bandRows};
        const uint32_t steps = sweep.stepCount(distance);
        uint32_t made = 0;
        for (uint32_t step = 0; step < steps; ++step) {
          const RowRange rows = sweep.rows(step, distance);
          EXPECT_EQ(rows.begin, made);
          EXPECT_LE(rows.end - rows.begin, std::min<uint64_t>(bandRows, height));
          if (const uint32_t first = sweep.rows(step, 0).end; first < height) {
            EXPECT_LE(rows.end + distance, std::max(distance, first));
          }
          made = rows.end;
        }
        EXPECT_EQ(made, height);
        EXPECT_EQ(steps == 1, bandRows >= height + distance);
      }
}

TEST(RollingTensor, CarriesOverWhatIsStillRead) {
  Graph graph;
  RollingTensor tensor("t", DataType::f32, {64, 5, 8});
  const TensorView first = tensor.advance(graph, {0, 16}, 0);
  EXPECT_EQ(first.storedByteSize(), 16u * 5 * 8 * 4);
  EXPECT_TRUE(graph.nodes.empty());
  const TensorView second = tensor.advance(graph, {16, 32}, 13);
  EXPECT_EQ(second.height, 64u);
  EXPECT_EQ(second.firstRow, 13);
  EXPECT_EQ(second.storedByteSize(), 19u * 5 * 8 * 4);
  ASSERT_EQ(graph.nodes.size(), 1u);
  EXPECT_EQ(outputRows(graph.nodes[0]), (RowRange{13, 16}));
  EXPECT_EQ(outputOf(graph.nodes[0]).value, second.value);
  EXPECT_THROW(tensor.advance(graph, {32, 48}, 12), std::logic_error);  // row 12 is gone
}

TEST(WindowBands, HoldWholeWindowsAndEveryRowOnce) {
  for (const uint32_t shift : {0u, 4u})
    for (const uint64_t bandRows : {3u, 8u, 20u, 40u, 48u, kWholeFrame}) {
      std::vector<int> count(48);
      const auto bands = windowBands(48, 8, shift, bandRows);
      for (const WindowBand& band : bands) {
        EXPECT_EQ((band.rows.end - band.rows.begin) % 8, 0u);
        if (band.isWhole()) {
          EXPECT_EQ(bands.size(), 1u);
          continue;
        }
        if (band.endRows == 0) {
          EXPECT_EQ(band.rows.begin % 8, shift);
        }
        for (uint32_t row = band.rows.begin; row < band.rows.end; ++row)
          ++count[band.endRows == 0 || row < band.endRows ? row : row + 40];
      }
      if (bands.size() > 1) {
        EXPECT_EQ(count, std::vector<int>(48, 1)) << shift << " " << bandRows;
      }
      EXPECT_EQ(bands.size() == 1, bandRows >= 48);
    }
}

TEST(Bands, LiveFromTheFirstWriteToTheLastRead) {
  Graph graph;
  graph.colour = graph.create("colour", DataType::f32, {16, 4, 4});
  graph.exposure = graph.create("exposure", DataType::f32, {1, 1, 4});
  const TensorView whole = graph.create("whole", DataType::f32, {16, 4, 4});
  graph.output = graph.create("output", DataType::f32, {16, 4, 4});
  copyRows(graph, "top", graph.colour, whole, {0, 8});
  copyRows(graph, "bottom", graph.colour, whole, {8, 16});
  copyRows(graph, "top", whole, graph.output, {0, 8});
  copyRows(graph, "bottom", whole, graph.output, {8, 16});
  const auto lives = lifetimes(graph, inPlaceStorage(graph));
  EXPECT_EQ(lives[whole.value].firstUse, 1u);
  EXPECT_EQ(lives[whole.value].lastUse, 4u);
  EXPECT_EQ(lives[graph.output.value].firstUse, 3u);
  EXPECT_EQ(lives[graph.output.value].lastUse, 5u);
}

TEST(Bands, ContinueAResidualOnlyOnceItIsRead) {
  const std::vector<float> weight(16), bias(4);
  Graph graph;
  graph.colour = graph.create("colour", DataType::f32, {16, 4, 4});
  graph.exposure = graph.create("exposure", DataType::f32, {1, 1, 4});
  const TensorView x = graph.create("x", DataType::f32, {16, 4, 4});
  graph.output = graph.create("output", DataType::f32, {16, 4, 4});
  const auto add = [&](RowRange rows) {
    graph.nodes.push_back({"sum", Linear{.input = graph.colour,
                                         .output = graph.output,
                                         .residual = x,
                                         .weight = weight,
                                         .bias = bias,
                                         .rows = rows}});
  };
  copyRows(graph, "x", graph.colour, x);
  add({0, 16});
  EXPECT_EQ(inPlaceStorage(graph)[graph.output.value], x.value);
  graph.nodes.pop_back();
  add({0, 8});
  add({8, 16});
  EXPECT_EQ(inPlaceStorage(graph)[graph.output.value], x.value);
  std::get<Linear>(graph.nodes.back().op).input = x;  // whose first rows are sums by then
  EXPECT_EQ(inPlaceStorage(graph)[graph.output.value], graph.output.value);
}

// Each band reads its own rows of x, or both the first ones.
TEST(Bands, OverwriteTheTensorWhoseRowsEachReads) {
  const std::vector<float> weight(16), bias(4);
  for (const bool readsAll : {false, true}) {
    Graph graph;
    graph.colour = graph.create("colour", DataType::f32, {16, 4, 4});
    graph.exposure = graph.create("exposure", DataType::f32, {1, 1, 4});
    const TensorView x = graph.create("x", DataType::f32, {16, 4, 4});
    const TensorView y = graph.create("y", DataType::f32, {16, 4, 4});
    graph.output = graph.create("output", DataType::f32, {16, 4, 4});
    copyRows(graph, "x", graph.colour, x);
    for (const RowRange rows : {RowRange{0, 8}, RowRange{8, 16}}) {
      const TensorView from = rowsOf(x, readsAll ? RowRange{0, 8} : rows);
      Linear op{.input = from, .output = graph.create("band", DataType::f32, {8, 4, 4}), .residual = from};
      op.weight = weight;
      op.bias = bias;
      graph.nodes.push_back({"band", op});
      copyRows(graph, "y", op.output, rowsOf(y, rows));
    }
    copyRows(graph, "output", y, graph.output);
    const std::vector<ValueId> storage = inPlaceStorage(graph);
    EXPECT_EQ(storage[y.value], readsAll ? y.value : x.value);
    const std::vector<Lifetime> lives = lifetimes(graph, storage);
    EXPECT_EQ(lives[storage[y.value]].lastUse, 6u);
  }
}

}  // namespace
}  // namespace xrds
