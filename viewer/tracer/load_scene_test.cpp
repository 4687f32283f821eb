#include <gtest/gtest.h>

#include <fstream>

#include "image/png_write.h"
#include "tests/temporary_folder.h"
#include "viewer/tracer/scene.h"
#include "xrds/error.h"

namespace xrds {
namespace {

namespace fs = std::filesystem;

class LoadScene : public testing::Test {
 protected:
  fs::path write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return folder_ / name;
  }
  const test::TemporaryFolder folder_;
};

// A triangle of corners (0, 0, 0), (2, 0, 0), (0, 1, 0), moved by (0, 0, 5), and a camera.
constexpr const char* kGltf = R"({
  "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1]}],
  "nodes": [{"mesh": 0, "translation": [0, 0, 5]}, {"camera": 0, "translation": [1, 2, 9]}],
  "cameras": [{"type": "perspective", "perspective": {"yfov": 0.6, "aspectRatio": 1.5, "znear": 0.1, "zfar": 100}}],
  "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}],
  "materials": [{"pbrMetallicRoughness": {"baseColorFactor": [0.9, 0.6, 0.3, 1], "metallicFactor": 1,
                 "roughnessFactor": 0.25}}, {"emissiveFactor": [1, 0.5, 0.25]}],
  "buffers": [{"byteLength": 44, "uri":
    "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAAAAQAAAAAAAAAAAAAAAAAAAgD8AAAAAAAABAAIAAAA="}],
  "bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 6}],
  "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [2, 1, 0]},
                {"bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR"}]})";

TEST_F(LoadScene, ReadsGltf) {
  const TraceScene scene = loadScene(write("metal.gltf", kGltf));
  EXPECT_EQ(scene.name, "metal");
  ASSERT_EQ(scene.triangles.size(), 1U);
  EXPECT_EQ(scene.triangles[0].positions, (std::array<Vec3, 3>{Vec3{0, 0, 5}, {2, 0, 5}, {0, 1, 5}}));
  EXPECT_NEAR(scene.triangles[0].normals[1].z, 1, 1e-6);
  const Material& material = scene.materials.at(scene.triangles[0].material);
  EXPECT_EQ(material.kind, MaterialKind::metal);
  EXPECT_EQ(material.colour, (Vec3{0.9F, 0.6F, 0.3F}));
  EXPECT_FLOAT_EQ(material.roughness, 0.25F);
  EXPECT_GT(scene.sky.size, 0U) << "nothing emits light";

  EXPECT_EQ(scene.camera.position, (Vec3{1, 2, 9}));
  EXPECT_NEAR(scene.camera.verticalFov, 0.6, 0.03) << "later versions of assimp round it otherwise";
  const Vec3 ahead = normalized(scene.camera.target - scene.camera.position);
  EXPECT_NEAR(ahead.z, -1, 1e-5);
  EXPECT_NEAR(scene.camera.up.y, 1, 1e-5);
}

TEST_F(LoadScene, ReadsWavefrontWithItsTexture) {
  Image picture(2, 1, 3);
  picture.pixels = {1, 0.5F, 0.25F, 0, 0, 1};
  writePng(folder_ / "picture.png", picture);
  write("quad.mtl",
        "newmtl painted\nKd 1 1 1\nmap_Kd picture.png\nnewmtl lamp\nKd 0 0 0\nKe 4 3 2\nnewmtl window\nKd 1 1 1\nd "
        "0.1\n");
  const fs::path file = write("quad.obj",
                              "mtllib quad.mtl\nv -1 0 0\nv 1 0 0\nv 1 2 0\nv -1 2 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
                              "usemtl painted\nf 1/1 2/2 3/3 4/4\nusemtl lamp\nf 1 2 3\nusemtl window\nf 2 3 4\n");
  const TraceScene scene = loadScene(file);
  ASSERT_EQ(scene.triangles.size(), 4U);
  size_t painted = 0, lamps = 0, windows = 0;
  for (const Triangle& triangle : scene.triangles) {
    const Material& material = scene.materials.at(triangle.material);
    lamps += material.emission == Vec3{4, 3, 2} ? 1 : 0;
    windows += material.kind == MaterialKind::glass ? 1 : 0;
    if (material.texture < 0) continue;
    ++painted;
    for (size_t i = 0; i < 3; ++i) {  // v counts from the top
      EXPECT_FLOAT_EQ(triangle.uvs[i].x, 0.5F + 0.5F * triangle.positions[i].x);
      EXPECT_FLOAT_EQ(triangle.uvs[i].y, 1 - 0.5F * triangle.positions[i].y);
    }
  }
  EXPECT_EQ(painted, 2U);
  EXPECT_EQ(lamps, 1U);
  EXPECT_EQ(windows, 1U);
  EXPECT_EQ(scene.sky.size, 0U) << "the lamp is light enough";
  ASSERT_EQ(scene.textures.size(), 1U);
  ASSERT_EQ(scene.textures[0].pixels.size(), 2U);
  EXPECT_NEAR(scene.textures[0].pixels[0].y, 0.5, 0.005);
  EXPECT_NEAR(scene.textures[0].pixels[0].z, 0.25, 0.005);
  EXPECT_NEAR(scene.textures[0].pixels[1].z, 1, 1e-6);
  // Everything is in sight of the camera.
  EXPECT_NEAR(scene.camera.target.y, 1, 1e-5);
  EXPECT_GT(scene.camera.position.z, 2);
}

TEST_F(LoadScene, SaysWhatIsWrong) {
  EXPECT_THROW(loadScene(folder_ / "missing.gltf"), Error);
  EXPECT_THROW(loadScene(write("broken.gltf", "{\"asset\": ")), Error);
  EXPECT_THROW(loadScene(write("empty.obj", "v 0 0 0\n")), Error);
  write("lost.mtl", "newmtl a\nmap_Kd nowhere.png\n");
  const fs::path lost =
      write("lost.obj", "mtllib lost.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl a\nf 1/1 2/1 3/1\n");
  try {
    loadScene(lost);
    FAIL() << "a missing texture went unnoticed";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("nowhere.png"), std::string::npos) << error.what();
  }
}

TEST(BuiltInScenes, AreThoseThatTheCompletionOffers) {
  std::string line = "    SCENE*) printf '%s\\n'";
  for (const std::string& name : builtInSceneNames()) line += " " + name;
  std::ifstream script(XRDS_SOURCE_FOLDER "/cli/completion/xrds.bash");
  const std::string text{std::istreambuf_iterator<char>(script), {}};
  EXPECT_NE(text.find(line + " ;;\n"), std::string::npos) << line;
}

}  // namespace
}  // namespace xrds
