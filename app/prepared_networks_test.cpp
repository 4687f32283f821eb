#include "app/prepared_networks.h"

#include <gtest/gtest.h>

#include <string>

namespace xrds {
namespace {

Model goldenModel(const std::string& name) {
  return Model(std::string(XRDS_GOLDEN_FOLDER) + "/" + name + ".model.safetensors");
}

class PreparedNetworksTest : public testing::Test {
 protected:
  std::unique_ptr<Upscaler> prepare(const Model& model, uint32_t size) {
    return std::make_unique<Upscaler>(device_, model, size, size, Upscaler::Options{});
  }

  Device device_;
  const Model model_ = goldenModel("s2_guided"), other_ = goldenModel("s1_guided");
  PreparedNetworks networks_;
};

TEST_F(PreparedNetworksTest, AreTakenForTheirModelAndSizeOnce) {
  std::unique_ptr<Upscaler> network = prepare(model_, 16);
  const Upscaler* const put = network.get();
  networks_.put(device_, model_, 16, 16, std::move(network));
  EXPECT_EQ(networks_.take(other_, 16, 16), nullptr);
  EXPECT_EQ(networks_.take(model_, 16, 32), nullptr);
  EXPECT_EQ(networks_.take(model_, 16, 16).get(), put);
  EXPECT_EQ(networks_.take(model_, 16, 16), nullptr);
}

TEST_F(PreparedNetworksTest, GoWhereNoneTakesThemForAWhile) {
  networks_.put(device_, model_, 16, 16, prepare(model_, 16));
  networks_.put(device_, model_, 24, 24, prepare(model_, 24));
  for (int frame = 0; frame < 100; ++frame) {
    std::unique_ptr<Upscaler> network = networks_.take(model_, 24, 24);
    ASSERT_NE(network, nullptr) << frame;
    networks_.put(device_, model_, 24, 24, std::move(network));
  }
  EXPECT_EQ(networks_.take(model_, 16, 16), nullptr);
}

TEST_F(PreparedNetworksTest, AreGivenBack) {
  networks_.put(device_, model_, 16, 16, prepare(model_, 16));
  networks_.clear();
  EXPECT_EQ(networks_.take(model_, 16, 16), nullptr);
}

}  // namespace
}  // namespace xrds
