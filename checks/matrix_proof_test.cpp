#include "checks/matrix_proof.h"

#include <gtest/gtest.h>

#include "tests/harness.h"
#include "xrds/error.h"

namespace xrds {
namespace {

TEST(MatrixProof, KeepsKernelsThatAreRight) {
  Gpu gpu(test::gpuOptions());
  gpu.setTraits(test::traitsOf(KernelFamily::matrix));
  EXPECT_TRUE(proveMatrixKernels(gpu));
  EXPECT_EQ(gpu.traits().family, KernelFamily::matrix);
}

TEST(MatrixProof, GivesUpKernelsThatAreWrong) {
  DeviceOptions options = test::gpuOptions();
  options.programs = [right = options.programs](std::string_view name) {
    return right(name.starts_with("conv3x3_matrix") ? "writes_nothing" : name);
  };
  Gpu gpu(options);
  gpu.setTraits(test::traitsOf(KernelFamily::matrix));
  EXPECT_FALSE(proveMatrixKernels(gpu));
  EXPECT_EQ(gpu.traits().family, KernelFamily::tile);
  EXPECT_EQ(gpu.traits().matrixUnits, MatrixUnits::none);
  EXPECT_TRUE(proveMatrixKernels(gpu));  // of those in use
}

TEST(MatrixProof, GivesUpAFusedLayerThatIsWrongAlone) {
  DeviceOptions options = test::gpuOptions();
  Gpu right(options);
  right.setTraits(test::traitsOf(KernelFamily::fused));
  EXPECT_TRUE(proveMatrixKernels(right));
  EXPECT_EQ(right.traits().family, KernelFamily::fused);

  options.programs = [all = options.programs](std::string_view name) {
    return all(name.starts_with("swin_layer_matrix") ? "writes_nothing" : name);
  };
  Gpu wrong(options);
  wrong.setTraits(test::traitsOf(KernelFamily::fused));
  EXPECT_FALSE(proveMatrixKernels(wrong));
  EXPECT_EQ(wrong.traits().family, KernelFamily::matrix);
  EXPECT_NE(wrong.traits().matrixUnits, MatrixUnits::none);
}

// With a program that writes nothing in place of those whose name begins so.
Gpu gpuWithout(const char* spoilt, KernelFamily family) {
  DeviceOptions options = test::gpuOptions();
  options.programs = [all = options.programs, spoilt](std::string_view name) {
    return all(name.starts_with(spoilt) ? "writes_nothing" : name);
  };
  Gpu gpu(options);
  gpu.setTraits(test::traitsOf(family));
  return gpu;
}

TEST(MatrixProof, RefusesAFamilyThatWasAskedForAndIsWrong) {
  const auto messageOf = [](const char* spoilt, const char* asked) -> std::string {
    Gpu gpu = gpuWithout(spoilt, kernelFamilyOf(asked));
    try {
      proveAskedKernels(gpu, asked);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(messageOf("nothing", "matrix"), "");
  EXPECT_EQ(messageOf("nothing", "fused"), "");
  EXPECT_EQ(messageOf("swin_layer_matrix", "matrix"), "");  // which does without
  for (const char* asked : {"matrix", "fused"})
    EXPECT_TRUE(messageOf("linear_matrix", asked).starts_with("The " + std::string(asked) + " kernels")) << asked;
  const std::string fused = messageOf("swin_layer_matrix", "fused");
  EXPECT_TRUE(fused.starts_with("The fused kernels")) << fused;
  EXPECT_TRUE(fused.ends_with("choose matrix, plain or tile.")) << fused;

  Gpu unasked = gpuWithout("linear_matrix", KernelFamily::matrix);
  proveAskedKernels(unasked, "");
  EXPECT_EQ(unasked.traits().family, KernelFamily::tile);
}

TEST(MatrixProof, RefusesAskedLayersThatDoNotFitTheDevice) {
  Gpu gpu(test::gpuOptions());
  DeviceTraits traits = test::traitsOf(KernelFamily::fused);
  traits.maxSharedBytes = 16384;
  gpu.setTraits(traits);
  EXPECT_THROW(proveAskedKernels(gpu, "fused"), Error);
}

TEST(MatrixProof, HasNothingToProveElsewhere) {
  Gpu gpu(test::gpuOptions());
  const KernelFamily family = gpu.traits().family;
  EXPECT_TRUE(proveMatrixKernels(gpu));
  EXPECT_EQ(gpu.traits().family, family);
}

}  // namespace
}  // namespace xrds
