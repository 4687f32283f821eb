#include <assimp/GltfMaterial.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <stb_image.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <map>
#include <memory>

#include "viewer/tracer/bvh.h"
#include "viewer/tracer/shapes.h"
#include "xrds/error.h"
#include "xrds/path_text.h"

namespace xrds {
namespace {

Vec3 vec(const aiVector3D& v) { return {v.x, v.y, v.z}; }
Vec3 vec(const aiColor3D& c) { return {c.r, c.g, c.b}; }

float linear(uint8_t code) {
  const float value = static_cast<float>(code) / 255;
  return value <= 0.04045F ? value / 12.92F : std::pow((value + 0.055F) / 1.055F, 2.4F);
}

/// Reads what assimp found of one file into a scene.
class Loader {
 public:
  Loader(const aiScene& source, std::filesystem::path folder, TraceScene& scene)
      : source_(source), folder_(std::move(folder)), scene_(scene) {}

  void materials() {
    for (unsigned i = 0; i < source_.mNumMaterials; ++i) addMaterial(scene_, material(*source_.mMaterials[i]));
  }
  void meshes() { node(*source_.mRootNode, aiMatrix4x4()); }
  void camera();

 private:
  Material material(const aiMaterial& from);
  void node(const aiNode& node, const aiMatrix4x4& above);
  void mesh(const aiMesh& mesh, const aiMatrix4x4& toWorld);
  int texture(const std::string& name);
  Texture decoded(const std::string& name) const;

  const aiScene& source_;
  std::filesystem::path folder_;
  TraceScene& scene_;
  std::map<std::string, int> textures_;
};

Texture Loader::decoded(const std::string& name) const {
  const aiTexture* inside = source_.GetEmbeddedTexture(name.c_str());
  int width = 0, height = 0, channels = 0;
  stbi_uc* bytes = nullptr;
  if (inside && inside->mHeight == 0)
    bytes = stbi_load_from_memory(reinterpret_cast<const stbi_uc*>(inside->pcData), static_cast<int>(inside->mWidth),
                                  &width, &height, &channels, 3);
  else
    bytes = stbi_load((folder_ / pathOf(name)).string().c_str(), &width, &height, &channels, 3);
  if (!bytes) throw Error("The texture '" + name + "' cannot be read (" + stbi_failure_reason() + ").");
  const std::unique_ptr<stbi_uc, void (*)(void*)> owner(bytes, stbi_image_free);
  Texture texture{static_cast<uint32_t>(width), static_cast<uint32_t>(height)};
  for (size_t i = 0; i < size_t{texture.width} * texture.height; ++i)
    texture.pixels.push_back({linear(bytes[3 * i]), linear(bytes[3 * i + 1]), linear(bytes[3 * i + 2])});
  return texture;
}

int Loader::texture(const std::string& name) {
  const auto [place, isNew] = textures_.try_emplace(name, -1);
  if (isNew) place->second = addTexture(scene_, decoded(name));
  return place->second;
}

// Of glTF's metallic-roughness model and Wavefront's: what comes nearest of the three kinds.
Material Loader::material(const aiMaterial& from) {
  Material to;
  aiColor3D colour(0.8F, 0.8F, 0.8F), emission(0, 0, 0);
  if (from.Get(AI_MATKEY_BASE_COLOR, colour) != AI_SUCCESS) from.Get(AI_MATKEY_COLOR_DIFFUSE, colour);
  from.Get(AI_MATKEY_COLOR_EMISSIVE, emission);
  to.colour = vec(colour);
  ai_real metallic = 0, transmission = 0, roughness = 0.5F, strength = 1, opacity = 1;
  from.Get(AI_MATKEY_EMISSIVE_INTENSITY, strength);
  to.emission = vec(emission) * strength;
  from.Get(AI_MATKEY_METALLIC_FACTOR, metallic);
  from.Get(AI_MATKEY_TRANSMISSION_FACTOR, transmission);
  from.Get(AI_MATKEY_ROUGHNESS_FACTOR, roughness);
  from.Get(AI_MATKEY_OPACITY, opacity);
  to.roughness = roughness;
  if (from.Get(AI_MATKEY_REFRACTI, to.refraction) != AI_SUCCESS || to.refraction <= 1) to.refraction = 1.5F;
  if (metallic >= 0.5F) to.kind = MaterialKind::metal;
  if (transmission >= 0.5F || opacity < 0.5F) to.kind = MaterialKind::glass;
  aiString name;
  for (const aiTextureType type : {aiTextureType_BASE_COLOR, aiTextureType_DIFFUSE})
    if (to.texture < 0 && from.GetTexture(type, 0, &name) == AI_SUCCESS) to.texture = texture(name.C_Str());
  return to;
}

void Loader::node(const aiNode& node, const aiMatrix4x4& above) {
  const aiMatrix4x4 toWorld = above * node.mTransformation;
  for (unsigned i = 0; i < node.mNumMeshes; ++i) mesh(*source_.mMeshes[node.mMeshes[i]], toWorld);
  for (unsigned i = 0; i < node.mNumChildren; ++i) this->node(*node.mChildren[i], toWorld);
}

void Loader::mesh(const aiMesh& mesh, const aiMatrix4x4& toWorld) {
  const aiMatrix3x3 normalToWorld = aiMatrix3x3(toWorld).Inverse().Transpose();
  for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
    const aiFace& face = mesh.mFaces[f];
    if (face.mNumIndices != 3) continue;
    Triangle triangle{.material = mesh.mMaterialIndex};
    for (unsigned i = 0; i < 3; ++i) {
      const unsigned vertex = face.mIndices[i];
      triangle.positions[i] = vec(toWorld * mesh.mVertices[vertex]);
      if (mesh.HasNormals()) triangle.normals[i] = normalized(vec(normalToWorld * mesh.mNormals[vertex]));
      if (mesh.HasTextureCoords(0))
        triangle.uvs[i] = {mesh.mTextureCoords[0][vertex].x, mesh.mTextureCoords[0][vertex].y};
    }
    const auto& [a, b, c] = triangle.positions;
    const Vec3 across = cross(b - a, c - a);
    if (!(length(across) > 0)) continue;
    for (Vec3& normal : triangle.normals)
      if (!(length(normal) > 0.5F)) normal = normalized(across);
    scene_.triangles.push_back(triangle);
  }
}

void Loader::camera() {
  Bounds bounds;
  for (const Triangle& triangle : scene_.triangles)
    for (const Vec3& position : triangle.positions) bounds.include(position);
  const Vec3 centre = bounds.centre();
  const float radius = 0.5F * length(bounds.upper - bounds.lower);
  scene_.camera.target = centre;
  scene_.camera.position =
      centre + normalized({0.35F, 0.3F, 1}) * (radius / std::sin(0.5F * scene_.camera.verticalFov));
  if (source_.mNumCameras == 0) return;

  // In a glTF file the camera sits at the origin of its node; assimp 5.2 gives its position a second time.
  const aiCamera& from = *source_.mCameras[0];
  aiMatrix4x4 toWorld;
  for (const aiNode* node = source_.mRootNode->FindNode(from.mName); node; node = node->mParent)
    toWorld = node->mTransformation * toWorld;
  const Vec3 position = vec(toWorld * aiVector3D()), ahead = normalized(vec(aiMatrix3x3(toWorld) * from.mLookAt));
  scene_.camera.position = position;
  scene_.camera.target = position + std::max(dot(centre - position, ahead), 0.1F * radius) * ahead;
  scene_.camera.up = normalized(vec(aiMatrix3x3(toWorld) * from.mUp));
  scene_.camera.verticalFov = from.mHorizontalFOV / (from.mAspect > 0 ? from.mAspect : 1);  // what assimp made it of
}

}  // namespace

TraceScene loadScene(const std::filesystem::path& file) {
  Assimp::Importer importer;
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  const aiScene* source = importer.ReadFile(
      file.string(), aiProcess_Triangulate | aiProcess_SortByPType | aiProcess_GenSmoothNormals | aiProcess_FlipUVs);
  if (!source) throw Error("The scene '" + file.string() + "' cannot be read (" + importer.GetErrorString() + ").");
  TraceScene scene{.name = file.stem().string()};
  Loader loader(*source, file.parent_path(), scene);
  loader.materials();
  loader.meshes();
  if (scene.triangles.empty()) throw Error("The scene '" + file.string() + "' has no surfaces.");
  loader.camera();
  const bool hasLight = std::any_of(scene.triangles.begin(), scene.triangles.end(), [&](const Triangle& triangle) {
    return luminance(scene.materials.at(triangle.material).emission) > 0;
  });
  if (!hasLight)
    scene.sky = makeSky(64, [](Vec3 d) { return mix({0.35F, 0.33F, 0.3F}, {1.0F, 1.05F, 1.15F}, 0.5F + 0.5F * d.y); });
  return scene;
}

}  // namespace xrds
