// Files of scenes (COLLADA, glTF, 3MF, FBX) by assimp: nodes with transforms, which hold meshes.
// Coordinates are those of the file's own axes, in metres. None of assimp's processing is asked
// for: polygons stay polygons, and vertices that a format lists once per corner are joined later,
// as those of STL.
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <system_error>

#include "libvpm/core/error.h"
#include "libvpm/file/text.h"
#include "libvpm/mesh/mesh_parsers.h"

namespace vpm {
namespace {

constexpr std::size_t kNamesShown = 12;

const char* hint_of(MeshFormat format, std::string_view bytes) {
  switch (format) {
    case MeshFormat::dae:
      return "dae";
    case MeshFormat::gltf:
      return bytes.starts_with("glTF") ? "glb" : "gltf";
    case MeshFormat::threemf:
      return "3mf";
    default:
      return "fbx";
  }
}

// A glTF file may name others beside it, so what is a file is read by its path.
const aiScene* import_scene(Assimp::Importer& importer, std::string_view bytes,
                            const std::string& name, MeshFormat format) {
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_USE_COLLADA_NAMES, true);
  importer.SetPropertyBool(AI_CONFIG_IMPORT_FBX_PRESERVE_PIVOTS, false);
  const bool is_gltf_text = format == MeshFormat::gltf && !bytes.starts_with("glTF");
  std::error_code fault;
  if (is_gltf_text && std::filesystem::is_regular_file(name, fault))
    return importer.ReadFile(name, 0);
  return importer.ReadFileFromMemory(bytes.data(), bytes.size(), 0, hint_of(format, bytes));
}

std::string name_of(const aiNode& node) {
  return file::shown({node.mName.C_Str(), node.mName.length});
}

bool has_faces(const aiScene& scene, const aiNode& node) {
  for (unsigned k = 0; k < node.mNumMeshes; ++k)
    if (scene.mMeshes[node.mMeshes[k]]->mNumFaces > 0) return true;
  return false;
}

struct PlacedNode {
  const aiNode* node;
  aiMatrix4x4 to_world;
};

// Appends the node and those below it that have faces.
void add_nodes(const aiScene& scene, const PlacedNode& top, std::vector<PlacedNode>& nodes) {
  std::vector<PlacedNode> open{top};
  while (!open.empty()) {
    const PlacedNode here = open.back();
    open.pop_back();
    if (has_faces(scene, *here.node)) nodes.push_back(here);
    for (unsigned k = here.node->mNumChildren; k-- > 0;) {
      const aiNode* const child = here.node->mChildren[k];
      open.push_back({child, here.to_world * child->mTransformation});
    }
  }
}

std::string names_of(const std::vector<PlacedNode>& nodes) {
  std::string names;
  for (std::size_t k = 0; k < std::min(nodes.size(), kNamesShown); ++k)
    names += (k > 0 ? ", " : "") + name_of(*nodes[k].node);
  return names + (nodes.size() > kNamesShown ? ", …" : "");
}

// Returns the nodes to be read: all, or the one of the given name with those below it.
std::vector<PlacedNode> chosen_nodes(const aiScene& scene, const std::string& name,
                                     const std::string& chosen) {
  std::vector<PlacedNode> all;
  add_nodes(scene, {scene.mRootNode, scene.mRootNode->mTransformation}, all);
  if (chosen.empty()) return all;
  const aiNode* const node = scene.mRootNode->FindNode(chosen.c_str());
  if (node == nullptr)
    refuse("it has no node '" + file::shown(chosen) + "'; nodes with faces: " + names_of(all),
           name);
  aiMatrix4x4 to_world;
  for (const aiNode* above = node; above != nullptr; above = above->mParent)
    to_world = above->mTransformation * to_world;
  std::vector<PlacedNode> below;
  add_nodes(scene, {node, to_world}, below);
  return below;
}

// Appends the mesh as the node places it; a mirrored one is turned over, as its surface is.
void add_mesh(const aiMesh& mesh, const aiMatrix4x4& to_world, RawMesh& result) {
  const std::size_t first = result.vertices.size();
  if (mesh.mNumVertices > kMaxVertices - first) refuse("more than 2^32 - 2 vertices", result.name);
  for (unsigned k = 0; k < mesh.mNumVertices; ++k) {
    const aiVector3D p = to_world * mesh.mVertices[k];
    const Vec3 vertex{p.x, p.y, p.z};
    if (!is_finite(vertex)) refuse("a coordinate is not finite", result.name);
    result.vertices.push_back(vertex);
  }
  const bool is_mirrored = to_world.Determinant() < 0;
  for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
    const aiFace& face = mesh.mFaces[f];
    for (unsigned k = 0; k < face.mNumIndices; ++k) {
      const unsigned index = face.mIndices[is_mirrored ? face.mNumIndices - 1 - k : k];
      if (index >= mesh.mNumVertices) refuse("a vertex index is out of range", result.name);
      result.corners.push_back(static_cast<std::uint32_t>(first + index));
    }
    result.end_polygon();
  }
}

// Returns what a unit of assimp's coordinates is in metres. It applies COLLADA's unit itself.
double unit_of(const aiScene& scene, MeshFormat format) {
  if (format == MeshFormat::threemf) return 0.001;
  constexpr double kCentimetre = 0.01;
  float factor = 1;
  double factor64 = 1;
  if (format != MeshFormat::fbx) return 1;
  if (scene.mMetaData != nullptr && scene.mMetaData->Get("UnitScaleFactor", factor))
    return kCentimetre * double{factor};
  if (scene.mMetaData != nullptr && scene.mMetaData->Get("UnitScaleFactor", factor64))
    return kCentimetre * factor64;
  return kCentimetre;
}

// Returns the axis that the file says is up. No rotation makes it another one.
char up_axis(const aiScene& scene, MeshFormat format, std::string_view bytes) {
  if (format == MeshFormat::threemf) return 'z';
  if (format == MeshFormat::dae)
    return bytes.find("Z_UP") != bytes.npos ? 'z' : bytes.find("X_UP") != bytes.npos ? 'x' : 'y';
  int axis = 1;
  if (format == MeshFormat::fbx && scene.mMetaData != nullptr) scene.mMetaData->Get("UpAxis", axis);
  return axis == 0 ? 'x' : axis == 2 ? 'z' : 'y';
}

// Says how units and axes were taken.
std::string text_of_frame(const aiScene& scene, MeshFormat format, double unit,
                          std::string_view bytes) {
  char text[160];
  std::snprintf(
      text, sizeof text, "its unit is taken to be %.6g m%s", unit,
      format == MeshFormat::threemf ? ", which 3MF has by default" : ", as the file says");
  const std::string units = format == MeshFormat::dae    ? "its unit was applied"
                            : format == MeshFormat::gltf ? "its coordinates are metres"
                                                         : text;
  return units + "; transforms of nodes were applied; " + up_axis(scene, format, bytes) +
         " is up, as in the file";
}

}  // namespace

RawMesh parse_scene(std::string_view bytes, const std::string& name, MeshFormat format,
                    const std::string& node) {
  RawMesh mesh;
  mesh.format = format;
  mesh.name = name;
  Assimp::Importer importer;
  const aiScene* scene = nullptr;
  std::string fault;
  try {
    scene = import_scene(importer, bytes, name, format);
    fault = importer.GetErrorString();
  } catch (const std::exception& error) {
    fault = error.what();
  }
  if (scene == nullptr || scene->mRootNode == nullptr) {
    const bool says_why = !fault.empty() && fault.find("No suitable reader") == fault.npos;
    refuse(std::string("assimp cannot read this ") + name_of(format) + " file" +
               (says_why ? ": " + file::shown(fault, 200)
                         : ", which is damaged or of a version that it does not know"),
           name, "save it again, or as OBJ, PLY or STL");
  }
  const std::vector<PlacedNode> nodes = chosen_nodes(*scene, name, node);
  const double unit = unit_of(*scene, format);
  for (const PlacedNode& placed : nodes)
    for (unsigned k = 0; k < placed.node->mNumMeshes; ++k)
      add_mesh(*scene->mMeshes[placed.node->mMeshes[k]], placed.to_world, mesh);
  for (Vec3& p : mesh.vertices) p = unit * p;
  mesh.notes.push_back(text_of_frame(*scene, format, unit, bytes));
  if (nodes.size() > 1) {
    mesh.notes.push_back("the meshes of " + std::to_string(nodes.size()) +
                         " nodes are joined: " + names_of(nodes) + "; `node` chooses one");
  }
  return mesh;
}

}  // namespace vpm
