// Writes the corpora that fuzzing starts from: small files of every kind that is read, whole ones and a few spoilt.
#include <OpenEXR/ImfCompression.h>

#include <cstdio>
#include <fstream>
#include <string>

#include "image/exr/write.h"
#include "image/test_files.h"
#include "network/network_model.h"
#include "xrds/error.h"

namespace xrds {
namespace {

namespace fs = std::filesystem;
using test::FixturePart;
using test::writeFixture;

constexpr Box kSmall{-1, 2, 7, 8};

void writeExrSeeds(const fs::path& folder) {
  for (int compression = Imf::NO_COMPRESSION; compression < Imf::NUM_COMPRESSION_METHODS; ++compression)
    for (const int tileSize : {0, 4})
      for (const Imf::PixelType type : {Imf::HALF, Imf::FLOAT}) {
        const std::string name = std::to_string(compression) + "_" + std::to_string(tileSize) + "_" +
                                 (type == Imf::HALF ? "half" : "float") + ".exr";
        const auto chosen = static_cast<Imf::Compression>(compression);
        writeFixture(folder / name, {{"", kSmall, kSmall, {"R", "G", "B", "A"}, type, chosen, tileSize}});
      }
  const auto zip = Imf::ZIP_COMPRESSION;
  const Box large{-2, 4, 15, 17};
  writeFixture(folder / "parts.exr", {{"beauty", kSmall, large, {"R", "G", "B"}, Imf::HALF, zip},
                                      {"albedo", large, large, {"albedo.R", "albedo.G", "albedo.B"}, Imf::HALF, zip, 4},
                                      {"normal", large, large, {"N.X", "N.Y", "N.Z"}, Imf::FLOAT, zip, 0, "left"}});
  writeFixture(
      folder / "layers.exr",
      {{"",
        kSmall,
        {0, 0, 9, 9},
        {"ViewLayer.Combined.R", "ViewLayer.Combined.G", "ViewLayer.Combined.B", "ViewLayer.Denoising Albedo.R",
         "ViewLayer.Denoising Albedo.G", "ViewLayer.Denoising Albedo.B", "ViewLayer.Denoising Normal.X",
         "ViewLayer.Denoising Normal.Y", "ViewLayer.Denoising Normal.Z", "ViewLayer.Depth.Z"}}});
  writeFixture(folder / "uint.exr", {{"", kSmall, kSmall, {"id"}, Imf::UINT, zip}});
  ExrOutput ours{kSmall, kSmall, {}, {{"xrds:version", "1"}, {"comments", "ours"}}, ExrPixelType::kHalf};
  writeExr(folder / "ours.exr", Image(9, 7, 4, 0.5F), ours);
}

void writeModelSeeds(const fs::path& folder) {
  NetworkConfig small{
      .scale = 2, .channels = 4, .auxChannels = 4, .groups = 1, .blocks = 1, .window = 2, .headChannels = 4};
  std::map<std::string, NetworkConfig> configs{{"rdst", small}};
  configs["rstb"] = configs["rdb"] = configs["kernels"] = configs["full"] = configs["colour"] = configs["untrained"] =
      small;
  configs["rstb"].block = BlockKind::rstb;
  configs["rdb"].block = BlockKind::rdb;
  configs["rdb"].cross = CrossKind::concat;
  configs["kernels"].kernels = configs["kernels"].auxKernels = 5;
  configs["kernels"].auxSkip = true;
  for (const char* input : {"colour", "diffuse", "glossy"}) configs["full"].auxInputs.emplace_back(input);
  configs["full"].colourKernels = 3;
  configs["full"].prefilter = 2;
  configs["colour"].auxInputs.clear();
  configs["colour"].auxChannels = 0;
  configs["colour"].base = BaseImage::bicubic;
  configs["untrained"].groups = 0;
  for (const auto& [name, config] : configs)
    for (const DataType type : {DataType::f32, DataType::f16})
      writeTensors(folder / (name + (type == DataType::f32 ? "_f32" : "_f16")), NetworkModel::random(config, 1).file(),
                   type);
}

}  // namespace
}  // namespace xrds

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: xrds_fuzz_seeds FOLDER\n");
    return 2;
  }
  try {
    const std::filesystem::path folder = argv[1];
    std::filesystem::create_directories(folder / "exr");
    std::filesystem::create_directories(folder / "model");
    xrds::writeExrSeeds(folder / "exr");
    xrds::writeModelSeeds(folder / "model");
  } catch (const std::exception& error) {
    std::fprintf(stderr, "xrds_fuzz_seeds: %s\n", error.what());
    return 1;
  }
}
