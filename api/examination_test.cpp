// The device's own examination: right devices pass it, spoilt ones do not.
#include "api/examination.h"

#include <gtest/gtest.h>

#include <set>

#include "checks/known_frame.h"
#include "checks/reference.h"
#include "shaders/programs.h"
#include "tests/harness.h"

namespace xrds {
namespace {

// A device of its own, whose programs are those of `source`.
Gpu gpuWith(ProgramSource source) {
  DeviceOptions options = test::gpuOptions();
  options.programs = std::move(source);
  return Gpu(std::move(options));
}

// Half floats where floats are expected.
std::span<const uint32_t> spoiltAttention(std::string_view name) {
  std::string other(name);
  if (name.starts_with("window_attention_")) other.replace(other.size() - 3, 3, "f16");
  return embeddedProgram(other);
}

TEST(KnownFrame, AnswerIsTheReferences) {
  const KnownFrame known;
  const Graph graph = buildGraph(known.model().config(), known.shape(), known.model().lookup(), {});
  HostMemory memory;
  setInputs(graph, known.input(), memory);
  runReference(graph, memory);
  ASSERT_EQ(KnownFrame::answer().size(), 3 * graph.output.pixelCount());
  size_t i = 0, dark = 0;
  for (uint32_t y = 0; y < graph.output.height; ++y)
    for (uint32_t x = 0; x < graph.output.width; ++x)
      for (uint32_t c = 0; c < 3; ++c) {
        const double expected = memory.at(graph.output, y, x, c);
        EXPECT_NEAR(KnownFrame::answer()[i++], expected, 1e-6 * (1 + expected)) << y << " " << x << " " << c;
        dark += expected == 0;
      }
  EXPECT_LT(dark, i / 10) << "the frame is mostly black, which tells nothing";
}

TEST(Examination, TrustsTheDevice) {
  for (const Precision precision : {Precision::fp32, Precision::fp16}) {
    std::set<std::string> operators;
    for (const KernelExamination& kernel : examineKernels(test::gpu(), precision, 2)) {
      EXPECT_TRUE(kernel.withinBound()) << kernel.program << " " << kernel.node << " " << kernel.rms;
      EXPECT_TRUE(kernel.repeatable) << kernel.program;
      EXPECT_GT(kernel.microseconds, 0);
      operators.insert(operatorOf(kernel.program));
    }
    const KernelFamily family = test::gpu().traits().family;
    const bool layersFused = family == KernelFamily::fused && precision == Precision::fp16;
    const size_t left = (layersFused ? 0 : 1) + (family == KernelFamily::lane ? 0 : 3);  // GPUs need no squares
    EXPECT_EQ(operators.size() + left, std::variant_size_v<Operator>) << "a kind of operator is not examined";
    const FrameExamination frame = examineKnownFrame(test::gpu(), precision, 2);
    EXPECT_TRUE(frame.withinBound()) << frame.rms;
    EXPECT_TRUE(frame.repeatable);
  }
}

TEST(Examination, FindsAWrongKernel) {
  Gpu gpu = gpuWith(spoiltAttention);
  int wrong = 0;
  for (const KernelExamination& kernel : examineKernels(gpu, Precision::fp32, 1)) {
    const bool attention = kernel.program.starts_with("window_attention_");
    EXPECT_EQ(kernel.withinBound(), !attention) << kernel.program << " " << kernel.rms;
    wrong += attention;
  }
  EXPECT_GT(wrong, 0);
  EXPECT_FALSE(examineKnownFrame(gpu, Precision::fp32, 1).withinBound());
}

}  // namespace
}  // namespace xrds
