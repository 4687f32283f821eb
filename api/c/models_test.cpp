// Models by the C API: found by their names, and chosen.
#include <gtest/gtest.h>

#include "tests/c_api.h"
#include "tests/environment_variable.h"
#include "xrds/shipped_models.h"

namespace xrds {
namespace {

using namespace test;

TEST(CApiModels, AreFoundByName) {
  char path[1024] = "";
  ASSERT_EQ(xrdsFindModel("xrds-x4-nano", path, sizeof path), XRDS_OK) << xrdsGetMessage();
  EXPECT_TRUE(std::string(path).ends_with("xrds-x4-nano.safetensors")) << path;
  EXPECT_EQ(xrdsFindModel("xrds-x4-nano", path, 8), XRDS_ERROR_ARGUMENT);
  EXPECT_EQ(xrdsFindModel("/nowhere/none", path, sizeof path), XRDS_ERROR_FAILED);
  EXPECT_EQ(xrdsFindModel("none", path, sizeof path), XRDS_ERROR_FAILED);
  EXPECT_NE(std::string(xrdsGetMessage()).find("There is no model 'none': give a .safetensors file or one of the "),
            std::string::npos)
      << xrdsGetMessage();
  EXPECT_NE(std::string(xrdsGetMessage()).find(", xrds-x4-compact, "), std::string::npos) << xrdsGetMessage();
  const std::string tooLong(5000, 'm');
  EXPECT_EQ(xrdsFindModel(tooLong.c_str(), path, sizeof path), XRDS_ERROR_FAILED);
  EXPECT_EQ(xrdsFindModel((tooLong + "/m").c_str(), path, sizeof path), XRDS_ERROR_FAILED);
  EXPECT_NO_THROW(EXPECT_TRUE(findModel(tooLong).empty()));
  const EnvironmentVariable folder("XRDS_MODELS", XRDS_GOLDEN_FOLDER);
  ASSERT_EQ(xrdsFindModel("s4_guided.model", path, sizeof path), XRDS_OK) << xrdsGetMessage();
  XrdsModel* model = nullptr;
  EXPECT_EQ(xrdsOpenModel("/nowhere/x.safetensors", &model), XRDS_ERROR_FAILED);
  ASSERT_EQ(xrdsOpenModel("s4_guided.model", &model), XRDS_OK) << xrdsGetMessage();
  EXPECT_EQ(xrdsGetModelScale(model), 4u);
  EXPECT_STREQ(xrdsGetModelMetadata(model, "license"), "MIT");
  EXPECT_EQ(xrdsGetModelMetadata(model, "nothing"), nullptr);
  xrdsCloseModel(model);
}

TEST(CApiModels, AreChosenByWhatThereIs) {
  const char* const guides[] = {"albedo", "normal", "colour"};
  const auto chosen = [&](uint32_t scale, uint32_t count, double samples) {
    char name[64] = "";
    EXPECT_EQ(xrdsChooseModel(scale, guides, count, samples, name, sizeof name), XRDS_OK) << xrdsGetMessage();
    return std::string(name);
  };
  EXPECT_EQ(chosen(4, 2, 0), "xrds-x4-compact");
  EXPECT_EQ(chosen(2, 2, 64), "xrds-x2-compact");
  EXPECT_EQ(chosen(4, 2, 4), "xrds-x4-live");
  EXPECT_EQ(chosen(4, 1, 4), "xrds-x4-compact-albedo");
  EXPECT_EQ(chosen(2, 3, 64), "xrds-x2-full");
  EXPECT_EQ(chosen(8, 3, 64), "xrds-x8-compact");  // of which no other is shipped
  EXPECT_EQ(chosen(2, 0, 0), "xrds-x4-compact-plain");
  char name[64] = "";
  EXPECT_EQ(xrdsChooseModel(5, guides, 2, 0, name, sizeof name), XRDS_ERROR_FAILED);
  EXPECT_NE(std::string(xrdsGetMessage()).find("upscales by 5 (xrds-x5-compact), only xrds-"), std::string::npos)
      << xrdsGetMessage();
  EXPECT_EQ(xrdsChooseModel(4, guides, 2, 0, name, 4), XRDS_ERROR_ARGUMENT);
  EXPECT_EQ(xrdsChooseModel(4, nullptr, 2, 0, name, sizeof name), XRDS_ERROR_ARGUMENT);
}

TEST(CApiModels, AreChosenByTheClassesAlike) {
  const std::string_view guides[] = {"albedo", "normal", "colour"};
  EXPECT_EQ(chooseModel(8, guides), "xrds-x8-compact");
  EXPECT_EQ(variantName(8, guides), "xrds-x8-full");  // which is not shipped
  EXPECT_EQ(chooseModel(2, {}), "xrds-x4-compact-plain");
  EXPECT_EQ(chooseModel(4, std::span(guides).first(2), 4), "xrds-x4-live");
  EXPECT_THROW(chooseModel(5, guides), Error);
}

}  // namespace
}  // namespace xrds
