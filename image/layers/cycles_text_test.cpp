#include "image/layers/cycles_text.h"

#include <OpenEXR/ImfStringAttribute.h>
#include <gtest/gtest.h>

#include <map>

#include "image/exr/attributes_stored.h"

namespace xrds {
namespace {

ExrAttributes with(const std::map<std::string, std::string>& texts) {
  Imf::Header header;
  for (const auto& [name, text] : texts) header.insert(name, Imf::StringAttribute(text));
  return attributesOf(header);
}

TEST(CyclesText, IsThatOfTheViewLayer) {
  const ExrAttributes two = with({{"cycles.A.samples", "4"}, {"cycles.A.b.samples", "64"}, {"cycles.A.time", "9"}});
  EXPECT_EQ(cyclesText(two, "A.Combined", "samples"), "4");
  EXPECT_EQ(cyclesText(two, "A.b.Noisy Image", "samples"), "64");
  EXPECT_EQ(cyclesText(two, "A.Combined.left", "samples"), "4");
  EXPECT_EQ(cyclesText(two, "A.Combined", "time"), "9");
  for (const char* other : {"B.Combined", "Combined", "", ".", "(unnamed)"})
    EXPECT_FALSE(cyclesText(two, other, "samples")) << other << ": 4 and 64 contradict each other";
}

TEST(CyclesText, IsThatOfAllWhereTheLayerIsOfNone) {
  EXPECT_EQ(cyclesText(with({{"cycles.A.samples", "4"}}), "(unnamed)", "samples"), "4");
  EXPECT_EQ(cyclesText(with({{"cycles.A.samples", "4"}, {"cycles.B.samples", "4"}}), "Combined", "samples"), "4");
  EXPECT_FALSE(cyclesText(with({{"samples", "4"}, {"cycles.A.sample", "4"}}), "A.Combined", "samples"));
}

}  // namespace
}  // namespace xrds
