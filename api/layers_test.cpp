// Light layers: they add up to the picture, each is what a reference in double precision makes of it, and what cannot
// be is refused.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include "checks/reference.h"
#include "network/network_model.h"
#include "xrds/auxiliary_input.h"
#include "xrds/xrds.hpp"

namespace xrds {
namespace {

constexpr uint32_t kWidth = 21, kHeight = 13;
constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInfinity = std::numeric_limits<float>::infinity();

Device& device() {
  static Device device;
  return device;
}

std::filesystem::path golden(const std::string& name) { return XRDS_GOLDEN_FOLDER "/" + name + ".model.safetensors"; }

/// Numbers in [low, high), of which a share is 0.
std::vector<float> numbers(size_t count, uint32_t seed, float low, float high, double black = 0) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> value(low, high), chance(0, 1);
  std::vector<float> values(count);
  for (float& one : values) one = chance(random) < black ? 0.F : value(random);
  return values;
}

/// A render of six lights: diffuse, direct and indirect, with a colour; emission in few pixels; a black one; a light
/// group that follows the albedo; an environment.
struct Render {
  enum Light { direct, indirect, emission, black, group, environment, count };

  explicit Render(const Model& of, uint32_t w = kWidth, uint32_t h = kHeight)
      : model(of), width(w), height(h), scale(of.scale()) {
    const size_t low = size_t{3} * width * height, full = low * scale * scale;
    for (size_t i = 0; i < model.auxiliaryInputs().size(); ++i)
      images.push_back(numbers(full, static_cast<uint32_t>(10 + i), 0, 1));
    lowColour = numbers(low, 1, 0, 0.9F, 0.1);
    fullColour = numbers(full, 2, 0, 0.9F, 0.1);
    lights = {numbers(low, 3, 0, 2),   numbers(low, 4, 0, 0.5F), numbers(low, 5, 0, 20, 0.9),
              std::vector<float>(low), numbers(low, 6, 0, 0.7F), numbers(low, 7, 0, 0.3F, 0.5)};
    outputs.assign(count, std::vector<float>(full, -1));
    colourOutput.assign(full, -1);
    picture.assign(full, -1);
    addUp();
  }
  void addUp() {
    colour.clear();
    for (size_t i = 0; i < lowColour.size(); ++i)
      colour.push_back((lights[direct][i] + lights[indirect][i]) * lowColour[i] + lights[emission][i] +
                       lights[group][i] + lights[environment][i]);
  }
  PixelView low(const std::vector<float>& pixels) const { return {pixels.data(), width, height}; }
  PixelView full(const std::vector<float>& pixels) const { return {pixels.data(), scale * width, scale * height}; }
  std::vector<PixelView> auxiliary() const {
    std::vector<PixelView> views;
    for (const auto& image : images) views.push_back(full(image));
    return views;
  }
  LayerSet layers(const std::vector<Light>& wanted = {direct, indirect, emission, black, group, environment}) {
    LayerSet set{.colours = {{low(lowColour), full(fullColour), colourOutput}}};
    for (const Light light : wanted)
      set.lights.push_back(
          {low(lights[light]), outputs[light], light <= indirect ? 0 : -1, light != emission && light != environment});
    return set;
  }
  LayerReport run(const Upscaler::Options& options = {}) {
    Upscaler upscaler(device(), model, width, height, options);
    const LayerSet set = layers();
    upscaler.run(low(colour), auxiliary(), picture, std::span(&set, 1));
    exposure = upscaler.exposure();
    return upscaler.layerReports().at(0);
  }
  double sumAt(size_t i) const {
    return (double{outputs[direct][i]} + outputs[indirect][i]) * colourOutput[i] + outputs[emission][i] +
           outputs[black][i] + outputs[group][i] + outputs[environment][i];
  }
  // The largest error of the sum over the picture, where that has light.
  void expectSum() const {
    double worst = 0;
    for (size_t i = 0; i < picture.size(); ++i) {
      const double wanted = std::max(picture[i], 0.F);
      worst = std::max(worst, std::abs(sumAt(i) - wanted) / std::max(wanted, 1e-20));
      for (const auto& output : outputs) ASSERT_TRUE(output[i] >= 0 && std::isfinite(output[i])) << output[i];
      ASSERT_TRUE(colourOutput[i] >= 0 && std::isfinite(colourOutput[i])) << colourOutput[i];
      ASSERT_EQ(outputs[black][i], 0);
    }
    EXPECT_LT(worst, 1e-6);
  }

  const Model& model;
  uint32_t width, height, scale;
  float exposure = 0;
  std::vector<std::vector<float>> images, lights, outputs;
  std::vector<float> lowColour, fullColour, colour, colourOutput, picture;
};

// Learned kernels, with filtered auxiliary images, a blended colour and a prefilter; bicubic bases; no base at all.
const std::string kModels[] = {
    "s4_kernels_aux_skip", "s4_aux_kernels5", "s4_full",          "s2_one_pixel_full_prefilter", "s2_prefilter3",
    "s1_guided",           "s2_demodulated",  "s8_bicubic_noaux", "s2_none_linear_albedo",       "s4_none_noaux"};

class LayersOf : public testing::TestWithParam<std::string> {};

TEST_P(LayersOf, AddUpToThePicture) {
  const Model model(golden(GetParam()));
  Render render(model);
  const LayerReport report = render.run();
  render.expectSum();
  EXPECT_NEAR(report.share, 1, 1e-5);
  EXPECT_EQ(report.unshared, 0u);
  // The picture is the one without layers, bit for bit.
  Render alone(model);
  Upscaler upscaler(device(), model, kWidth, kHeight, {});
  upscaler.run(alone.low(alone.colour), alone.auxiliary(), alone.picture);
  EXPECT_EQ(render.picture, alone.picture);
  EXPECT_EQ(render.exposure, upscaler.exposure());
}

// The whole graph and the sharing in double precision.
TEST_P(LayersOf, MatchAReference) {
  const Model model(golden(GetParam()));
  Render render(model);
  render.run();
  const NetworkModel weights = NetworkModel::read(golden(GetParam()));
  const Graph graph =
      buildGraph(weights.config(), {kHeight, kWidth}, weights.lookup(), {.bandRows = kWholeFrame, .layers = 7});
  FrameInput input{render.low(render.colour), render.auxiliary()};
  const int first = weights.config().auxOffset(kAlbedo.name);
  const uint32_t s = render.scale;
  std::vector<std::vector<float>> images = render.lights;
  for (const auto light : {Render::direct, Render::indirect})
    for (size_t i = 0; i < render.colour.size(); ++i) images[light][i] *= render.lowColour[i];
  std::vector<float> means(render.colour.size());  // of the albedo
  for (size_t i = 0; first >= 0 && i < render.picture.size(); ++i) {
    const size_t pixel = i / 3, row = pixel / (s * kWidth) / s, column = pixel % (s * kWidth) / s;
    means[3 * (row * kWidth + column) + i % 3] +=
        (render.images[static_cast<size_t>(first) / 3][i] + 0.02F) / float(s * s);
  }
  images[Render::black] = means;
  images.push_back(render.lowColour);
  for (const auto& image : images) input.layers.push_back({render.low(image), {}});
  HostMemory memory;
  setInputs(graph, input, memory);
  runReference(graph, memory);
  double difference[Render::count] = {}, power[Render::count] = {};
  for (size_t i = 0; i < render.picture.size(); ++i) {
    const auto mean = [&](size_t k) { return std::max(0.0, memory.storage(graph.layerMeans[k])[i / 3 * 4 + i % 3]); };
    const auto per = [](double a, double b) { return b > 0 ? a / b : 0; };
    const double albedo =
        first >= 0 ? per(render.images[static_cast<size_t>(first) / 3][i] + 0.02, mean(Render::black)) : 1;
    const double colour = per(render.fullColour[i], mean(Render::count));
    double guesses[Render::count] = {mean(0) * colour, mean(1) * colour, mean(2), 0, mean(4) * albedo, mean(5)};
    const double wanted = std::max(0.0, memory.storage(graph.output)[i / 3 * 4 + i % 3]);
    const double sum = std::accumulate(guesses, guesses + Render::count, 0.0);
    if (sum * 16 < wanted) continue;  // other tests have what becomes of it
    for (size_t k = 0; k < Render::count; ++k) {
      const double expected = sum > 0 ? wanted * guesses[k] / sum : 0;
      const double found = double{render.outputs[k][i]} * (k <= Render::indirect ? render.colourOutput[i] : 1.F);
      difference[k] += (found - expected) * (found - expected);
      power[k] += expected * expected;
    }
  }
  for (size_t k = 0; k < Render::count; ++k) EXPECT_LE(std::sqrt(difference[k]), 1e-4 * std::sqrt(power[k])) << k;
}

INSTANTIATE_TEST_SUITE_P(Models, LayersOf, testing::ValuesIn(kModels),
                         [](const auto& parameter) { return parameter.param; });

// They are as they are given, times their colour, and share the picture.
TEST(Layers, OfADenoiserShareItsPicture) {
  for (const char* name : {"unet/hdr_small", "unet/ldr_albedo_normal_small"}) {
    const Model model(golden(name));
    Render render(model), alone(model);
    EXPECT_NEAR(render.run().share, 1, 1e-5);
    render.expectSum();
    Upscaler upscaler(device(), model, kWidth, kHeight, {});
    upscaler.run(alone.low(alone.colour), alone.auxiliary(), alone.picture);
    EXPECT_EQ(render.picture, alone.picture);
    for (size_t i = 0; i < render.picture.size(); ++i) {
      double guesses[Render::count], sum = 0;
      for (size_t k = 0; k < Render::count; ++k)
        sum += guesses[k] = render.lights[k][i] * (k > Render::indirect      ? 1.0
                                                   : render.lowColour[i] > 0 ? render.fullColour[i]
                                                                             : 0);
      const double wanted = std::max(render.picture[i], 0.F);
      if (sum * 16 < wanted || !(sum > 0)) continue;  // other tests have what becomes of it
      for (size_t k = 0; k < Render::count; ++k) {
        const double found = double{render.outputs[k][i]} * (k <= Render::indirect ? render.colourOutput[i] : 1.F);
        ASSERT_NEAR(found, wanted * guesses[k] / sum, 1e-5 * wanted) << name << " " << k << " " << i;
      }
    }
  }
  const Model ofAlbedo(golden("unet/albedo_small"));
  Render render(ofAlbedo);
  EXPECT_THROW(render.run(), Error);
}

// Everything that a frame may be cut into or repeated by; the untrained guided base, whose kernels are joint bilateral.
TEST(Layers, AddUpWhateverTheOptions) {
  const Model model = Model::untrained(4, "guided");
  const Upscaler::Options kOptions[] = {{.fp16 = true},
                                        {.tiles = {.exact = true, .columns = 2, .rows = 2}},
                                        {.tiles = {.wrap = true, .columns = 2}},
                                        {.exposure = 0.01F},
                                        {.ensemble = 2},
                                        {.ensemble = 8}};
  for (const Upscaler::Options& options : kOptions) {
    Render render(model, 48, 40);
    EXPECT_NEAR(render.run(options).share, 1, 1e-5);
    render.expectSum();
  }
}

TEST(Layers, AreTheSameInTiles) {
  const Model model(golden("s4_guided"));
  Render whole(model, 112, 16), tiled(model, 112, 16);
  whole.run();
  tiled.run({.tiles = {.exact = true, .columns = 2}});
  EXPECT_EQ(whole.picture, tiled.picture);
  EXPECT_EQ(whole.outputs, tiled.outputs);
}

TEST(Layers, OfAnEnsembleAreMeansOfMirroredFrames) {
  const Model model = Model::untrained(2, "guided");  // whose kernels do not change when they are mirrored
  Render once(model), often(model);
  once.run();
  often.run({.ensemble = 8});
  for (size_t k = 0; k < Render::count; ++k)
    for (size_t i = 0; i < once.picture.size(); ++i)
      ASSERT_NEAR(once.outputs[k][i], often.outputs[k][i], 1e-3 * (1 + once.outputs[k][i])) << k << " " << i;
}

// A part of the light gets the same share whether the rest is given or not.
TEST(Layers, ThatAreAPartGetTheirPart) {
  const Model model(golden("s4_guided"));
  Render all(model), part(model);
  all.run();
  Upscaler upscaler(device(), model, kWidth, kHeight, {});
  const LayerSet set = part.layers({Render::emission});
  upscaler.run(part.low(part.colour), part.auxiliary(), part.picture, std::span(&set, 1));
  EXPECT_LT(upscaler.layerReports().at(0).share, 0.9);
  double sum = 0, found = 0;
  for (size_t i = 0; i < all.picture.size(); ++i) {
    ASSERT_LE(part.outputs[Render::emission][i], part.picture[i] * 1.000001F);
    sum += all.outputs[Render::emission][i];
    found += part.outputs[Render::emission][i];
  }
  EXPECT_NEAR(found / sum, 1, 0.05);  // the rest follows the albedo, as not all of the others did
}

TEST(Layers, GoOnAfterFramesWithout) {
  const Model model(golden("s4_guided"));
  Render render(model), again(model);
  render.run();
  Upscaler upscaler(device(), model, kWidth, kHeight, {});
  upscaler.run(again.low(again.colour), again.auxiliary(), again.picture);
  const LayerSet set = again.layers();
  upscaler.run(again.low(again.colour), again.auxiliary(), again.picture, std::span(&set, 1));
  EXPECT_EQ(render.outputs, again.outputs);
  upscaler.run(again.low(again.colour), again.auxiliary(), again.picture);
  EXPECT_EQ(render.picture, again.picture);
}

// Colours that are black at full resolution leave light without a place; broken pixels count as their neighbours.
TEST(Layers, InventNothing) {
  const Model model(golden("s4_guided"));
  Render render(model);
  std::fill(render.fullColour.begin(), render.fullColour.end(), 0.F);
  for (const auto light : {Render::group, Render::environment, Render::emission})
    std::fill(render.lights[light].begin(), render.lights[light].end(), 0.F);
  render.addUp();
  render.lights[Render::direct][30] = kNan;
  render.lights[Render::indirect][60] = kInfinity;
  render.lights[Render::direct][90] = -5;
  render.lights[Render::direct][200] = 3e38F;
  render.fullColour[300] = kNan;
  render.lowColour[33] = -kInfinity;
  const LayerReport report = render.run();
  render.expectSum();
  EXPECT_GT(report.raisedColours, render.picture.size() / 4);
  EXPECT_EQ(report.unshared, 0u);
}

TEST(Layers, OfABlackFrameAreBlack) {
  const Model model(golden("s4_guided"));
  Render render(model);
  for (auto& light : render.lights) std::fill(light.begin(), light.end(), 0.F);
  std::fill(render.colour.begin(), render.colour.end(), 0.F);
  render.run();
  for (const auto& output : render.outputs)
    EXPECT_TRUE(std::all_of(output.begin(), output.end(), [](float value) { return value == 0; }));
  EXPECT_EQ(render.colourOutput, render.fullColour);
}

// What the error says; "nothing" if there is none.
std::string refusal(const std::function<void(Render&, LayerSet&)>& change, const Upscaler::Options& options = {}) {
  const Model model(golden("s4_guided"));
  Render render(model);
  LayerSet layers = render.layers();
  change(render, layers);
  Upscaler upscaler(device(), model, kWidth, kHeight, options);
  try {
    upscaler.run(render.low(render.colour), render.auxiliary(), render.picture, std::span(&layers, 1));
  } catch (const InvalidArgument& error) {
    // The upscaler is as good as before.
    upscaler.run(render.low(render.colour), render.auxiliary(), render.picture);
    EXPECT_TRUE(std::isfinite(render.picture[0]));
    return error.what();
  }
  return "nothing";
}

TEST(Layers, ThatDoNotFitAreRefused) {
  const auto expect = [](const std::string& words, const std::string& message) {
    EXPECT_NE(message.find(words), std::string::npos) << message;
  };
  expect("Light layer 1 is 20 x 13 pixels, expected 21 x 13",
         refusal([](Render&, LayerSet& layers) { layers.lights[1].light.width = 20; }));
  expect("light layer image has no channel 0",
         refusal([](Render&, LayerSet& layers) { layers.lights[0].light.pixels = nullptr; }));
  expect("output of light layer 2 has room for 3 numbers",
         refusal([](Render&, LayerSet& layers) { layers.lights[2].output = layers.lights[2].output.first(3); }));
  expect("colour 1, but there are 1", refusal([](Render&, LayerSet& layers) { layers.lights[0].colour = 1; }));
  expect("full-resolution colour pass 0",
         refusal([](Render&, LayerSet& layers) { layers.colours[0].full = layers.colours[0].low; }));
  expect("whole", refusal([](Render& render, LayerSet& layers) { layers.whole = render.full(render.fullColour); }));
  for (const SkipOptions& skip : {SkipOptions{.bound = 0.005F}, SkipOptions{.keepUnchanged = true}})
    expect("leaves out windows", refusal([](Render&, LayerSet&) {}, {.skip = skip}));
}

}  // namespace
}  // namespace xrds
