#include "graph/matrix_proof.h"

#include <gtest/gtest.h>

#include "tests/harness.h"

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
    return right(name.starts_with("conv3x3_matrix") ? "conv3x3_plain_f16" : name);
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

  // A program that writes nothing.
  options.programs = [all = options.programs](std::string_view name) {
    return all(name.starts_with("swin_layer_matrix") ? "twice_plus" : name);
  };
  Gpu wrong(options);
  wrong.setTraits(test::traitsOf(KernelFamily::fused));
  EXPECT_FALSE(proveMatrixKernels(wrong));
  EXPECT_EQ(wrong.traits().family, KernelFamily::matrix);
  EXPECT_NE(wrong.traits().matrixUnits, MatrixUnits::none);
}

TEST(MatrixProof, HasNothingToProveElsewhere) {
  Gpu gpu(test::gpuOptions());
  const KernelFamily family = gpu.traits().family;
  EXPECT_TRUE(proveMatrixKernels(gpu));
  EXPECT_EQ(gpu.traits().family, family);
}

}  // namespace
}  // namespace xrds
