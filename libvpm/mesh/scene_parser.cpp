// Files of scenes (COLLADA, glTF, FBX) by assimp: nodes with transforms, which hold meshes.
// Coordinates are those of the file's own axes, in metres. None of assimp's processing is asked
// for: polygons stay polygons, and vertices that a format lists once per corner are joined later,
// as those of STL. It crashes on some files, so it reads in a process of its own, which sends back
// the raw mesh.
#include <assimp/DefaultIOSystem.h>
#include <assimp/MemoryIOWrapper.h>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <exception>
#include <filesystem>
#include <functional>
#include <new>
#include <nlohmann/json.hpp>
#include <optional>
#include <system_error>

#include "libvpm/core/error.h"
#include "libvpm/file/stream.h"
#include "libvpm/file/text.h"
#include "libvpm/mesh/child_process.h"
#include "libvpm/mesh/mesh_parsers.h"
#include "libvpm/mesh/scene_header.h"
#include "libvpm/mesh/scene_nodes.h"
#include "libvpm/mesh/scene_skin.h"

namespace vpm {
namespace {

const char* hint_of(MeshFormat format, std::string_view bytes) {
  switch (format) {
    case MeshFormat::dae:
      return "dae";
    case MeshFormat::gltf:
      return bytes.starts_with("glTF") ? "glb" : "gltf";
    default:
      return "fbx";
  }
}

// Opens one file from memory, and those that it names from where they are; where there is none of
// the name as written, %NN in it is taken for a byte, as in addresses.
class FileInMemory : public Assimp::DefaultIOSystem {
 public:
  FileInMemory(std::string path, std::string_view bytes) : path_(std::move(path)), bytes_(bytes) {}

  bool Exists(const char* path) const override {
    return path == path_ || DefaultIOSystem::Exists(path) ||
           DefaultIOSystem::Exists(percent_decoded(path).c_str());
  }

  Assimp::IOStream* Open(const char* path, const char* mode) override {
    if (path != path_) {
      const bool is_there = DefaultIOSystem::Exists(path);
      return DefaultIOSystem::Open(is_there ? path : percent_decoded(path).c_str(), mode);
    }
    return new Assimp::MemoryIOStream(reinterpret_cast<const std::uint8_t*>(bytes_.data()),
                                      bytes_.size());
  }

 private:
  std::string path_;
  std::string_view bytes_;
};

// A glTF file may name others beside it, so what is a file is read by its path, with the suffix by
// which assimp tells text from binary. Nodes without meshes get none that would show them.
const aiScene* import_scene(Assimp::Importer& importer, std::string_view bytes,
                            const std::string& name, MeshFormat format) {
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_USE_COLLADA_NAMES, true);
  importer.SetPropertyBool(AI_CONFIG_IMPORT_FBX_PRESERVE_PIVOTS, false);
  importer.SetPropertyBool(AI_CONFIG_IMPORT_NO_SKELETON_MESHES, true);
  const char* const hint = hint_of(format, bytes);
  std::error_code fault;
  if (format == MeshFormat::gltf && std::filesystem::is_regular_file(name, fault)) {
    const std::string path = name + "." + hint;
    importer.SetIOHandler(new FileInMemory(path, bytes));
    return importer.ReadFile(path, 0);
  }
  return importer.ReadFileFromMemory(bytes.data(), bytes.size(), 0, hint);
}

// Appends the mesh with its vertices where they are placed; a mirrored one is turned over, as its
// surface is.
void add_mesh(const aiMesh& mesh, const PlacedVertices& placed, RawMesh& result) {
  const std::size_t first = result.vertices.size();
  if (mesh.mNumVertices > kMaxVertices - first) refuse("more than 2^32 - 2 vertices", result.name);
  for (const aiVector3D& p : placed.vertices) {
    const Vec3 vertex{p.x, p.y, p.z};
    if (!is_finite(vertex)) refuse("a coordinate is not finite", result.name);
    result.vertices.push_back(vertex);
  }
  for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
    const aiFace& face = mesh.mFaces[f];
    for (unsigned k = 0; k < face.mNumIndices; ++k) {
      const unsigned index = face.mIndices[placed.is_mirrored ? face.mNumIndices - 1 - k : k];
      if (index >= mesh.mNumVertices) refuse("a vertex index is out of range", result.name);
      result.corners.push_back(static_cast<std::uint32_t>(first + index));
    }
    result.end_polygon();
  }
}

constexpr const char* kSkinIsNotApplied =
    "it has a skin, which is not applied: check its size, or export it without the skin";

struct PlacedNode {
  const aiNode* node;
  aiMatrix4x4 to_world;
  std::size_t parent;  // index of the node above, its own for the root
};

// Returns all nodes, each before those below it.
std::vector<PlacedNode> placed_nodes(const aiScene& scene, const aiMatrix4x4& of_root) {
  std::vector<PlacedNode> nodes;
  std::vector<PlacedNode> open{{scene.mRootNode, of_root, 0}};
  while (!open.empty()) {
    const PlacedNode here = open.back();
    open.pop_back();
    const std::size_t at = nodes.size();
    nodes.push_back(here);
    for (unsigned k = here.node->mNumChildren; k-- > 0;) {
      const aiNode* const child = here.node->mChildren[k];
      open.push_back({child, here.to_world * child->mTransformation, at});
    }
  }
  return nodes;
}

std::vector<SceneNode> named_nodes(const aiScene& scene, const std::vector<PlacedNode>& placed) {
  std::vector<SceneNode> nodes;
  for (const PlacedNode& here : placed) {
    const aiNode& node = *here.node;
    const bool has_faces =
        std::any_of(node.mMeshes, node.mMeshes + node.mNumMeshes,
                    [&](unsigned mesh) { return scene.mMeshes[mesh]->mNumFaces > 0; });
    nodes.push_back({node.mName.C_Str(), here.parent, has_faces});
  }
  return nodes;
}

PlacesByName places_of(const std::vector<PlacedNode>& nodes) {
  PlacesByName places;
  for (const PlacedNode& placed : nodes)
    places[placed.node->mName.C_Str()].push_back(placed.to_world);
  return places;
}

// Appends the meshes of the nodes. The joints of a skin place its mesh, not the node, as glTF and
// COLLADA say; those of FBX stand for deformations only.
void add_nodes(const aiScene& scene, const std::vector<PlacedNode>& placed,
               const std::vector<std::size_t>& nodes, MeshFormat format, RawMesh& result) {
  const PlacesByName places = places_of(placed);
  std::size_t posed = 0, without_pose = 0;
  for (const std::size_t k : nodes) {
    const aiNode& node = *placed[k].node;
    for (unsigned m = 0; m < node.mNumMeshes; ++m) {
      const aiMesh& mesh = *scene.mMeshes[node.mMeshes[m]];
      const auto pose =
          mesh.HasBones() && format != MeshFormat::fbx ? rest_pose(mesh, places) : std::nullopt;
      if (mesh.HasBones()) ++(pose ? posed : without_pose);
      const bool by_node = !mesh.HasBones() || format != MeshFormat::gltf;
      add_mesh(mesh, pose ? *pose : moved(mesh, by_node ? placed[k].to_world : aiMatrix4x4()),
               result);
    }
  }
  if (posed > 0) {
    result.notes.push_back(
        "it has a skin: the joints place its mesh as the file does, and the "
        "transform of its node does not count");
  }
  if (without_pose > 0) result.notes.push_back(kSkinIsNotApplied);
}

// Holds what the file says of itself: how long its unit is in metres, as told, which axis is up,
// and notes about what is not applied.
struct FileFacts {
  double metres = 1;
  std::string unit;
  char up = 'y';
  std::vector<std::string> notes;
};

std::string text_of_metres(double metres) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g m", metres);
  return text;
}

FileFacts facts_of_collada(std::string_view text, const std::string& name) {
  const ColladaHeader header = collada_header(text, name);
  FileFacts facts{1, "its coordinates are taken to be metres, as it names no unit", header.up, {}};
  if (header.metres) {
    facts.metres = *header.metres;
    facts.unit = "its unit of " + text_of_metres(*header.metres) + " was applied";
  } else if (!header.unit_name.empty()) {
    facts.unit = "its coordinates are taken to be metres, as its unit '" +
                 file::shown(header.unit_name) + "' has no length (meter)";
  }
  if (header.has_morph)
    facts.notes.push_back("it has morph targets, which are not applied: check its shape");
  return facts;
}

FileFacts facts_of_fbx(const aiScene& scene) {
  constexpr double kCentimetre = 0.01;
  float factor = 1;
  double centimetres = 1;
  int axis = 1;
  bool is_said = false;
  if (const aiMetadata* const said = scene.mMetaData) {
    is_said = said->Get("UnitScaleFactor", centimetres);
    if (!is_said && said->Get("UnitScaleFactor", factor)) {
      is_said = true;
      centimetres = factor;
    }
    said->Get("UpAxis", axis);
  }
  const double metres = kCentimetre * centimetres;
  return {metres,
          "its unit is taken to be " + text_of_metres(metres) +
              (is_said ? ", as the file says" : ", which FBX has by default"),
          axis == 0   ? 'x'
          : axis == 2 ? 'z'
                      : 'y',
          {}};
}

// Returns what the file itself tells, of those formats for which no scene is needed.
FileFacts facts_of(MeshFormat format, std::string_view bytes, const std::string& name) {
  if (format == MeshFormat::dae) return facts_of_collada(bytes, name);
  return {1, "its coordinates are metres", 'y', {}};
}

// Returns the transform of the root node. That of COLLADA is the unit as assimp reads it, which
// takes what it cannot read for 1; ours replaces it where they differ by more than rounding.
aiMatrix4x4 root_transform(const aiScene& scene, MeshFormat format, double metres) {
  constexpr double kRounding = 1e-6;
  const aiMatrix4x4& root = scene.mRootNode->mTransformation;
  if (format != MeshFormat::dae || std::abs(double{root.a1} - metres) <= kRounding * metres)
    return root;
  aiMatrix4x4 unit;
  const auto scale = static_cast<float>(metres);
  return aiMatrix4x4::Scaling({scale, scale, scale}, unit);
}

// Reads by assimp; see parse_scene, which tells the mesh its format and name.
RawMesh read_scene(std::string_view bytes, const std::string& name, MeshFormat format,
                   const std::string& node) {
  FileFacts facts = facts_of(format, bytes, name);
  RawMesh mesh;
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
  if (fault.find("bad_alloc") != fault.npos) throw std::bad_alloc();
  if (scene == nullptr || scene->mRootNode == nullptr) {
    // Messages that name the buffer in memory, or no reader, say nothing of the file.
    const bool says_why = !fault.empty() && fault.find("No suitable reader") == fault.npos &&
                          fault.find(AI_MEMORYIO_MAGIC_FILENAME) == fault.npos;
    refuse(std::string("assimp cannot read this ") + name_of(format) + " file" +
               (says_why ? ": " + file::shown(fault, 200)
                         : ", which is damaged or of a version that it does not know"),
           name, kSaveAgain);
  }
  if (format == MeshFormat::fbx) facts = facts_of_fbx(*scene);
  const std::vector<PlacedNode> placed =
      placed_nodes(*scene, root_transform(*scene, format, facts.metres));
  const NodeChoice choice(named_nodes(*scene, placed), name);
  const std::vector<std::size_t> nodes = choice.choose(node);
  mesh.metres_per_unit = facts.metres;
  if (nodes.empty()) refuse("it has no faces, only nodes", name, "export it with its mesh");
  add_nodes(*scene, placed, nodes, format, mesh);
  if (format != MeshFormat::dae)  // its root has done so
    for (Vec3& p : mesh.vertices) p = facts.metres * p;
  mesh.notes.insert(mesh.notes.begin(), facts.unit + "; transforms of nodes were applied; " +
                                            facts.up + " is up, as in the file");
  if (nodes.size() > 1) mesh.notes.push_back(choice.joined(nodes));
  mesh.notes.insert(mesh.notes.end(), facts.notes.begin(), facts.notes.end());
  return mesh;
}

template <class T>
void append(const std::vector<T>& list, std::string& bytes) {
  bytes.append(reinterpret_cast<const char*>(list.data()), list.size() * sizeof(T));
}

template <class T>
void take(std::vector<T>& list, std::size_t count, std::string_view& bytes) {
  list.resize(count);
  if (count > 0) std::memcpy(list.data(), bytes.data(), count * sizeof(T));
  bytes.remove_prefix(count * sizeof(T));
}

// Returns what read_scene does, a mesh or an error, as bytes: a line of JSON, then the lists. The
// error is `no_memory` where memory ends.
std::string scene_as_bytes(const std::function<RawMesh()>& read, const Error& no_memory) {
  constexpr auto kReplace = nlohmann::json::error_handler_t::replace;
  nlohmann::json head;
  const auto take_error = [&](const Error& fault) {
    head = {{"problem", fault.problem()}, {"where", fault.where()}, {"hint", fault.hint()}};
  };
  try {
    const RawMesh mesh = read();
    head = {{"vertices", mesh.vertices.size()},
            {"corners", mesh.corners.size()},
            {"polygons", mesh.polygon_end.size()},
            {"dropped", mesh.dropped_polygons},
            {"notes", mesh.notes},
            {"metres_per_unit", mesh.metres_per_unit}};
    std::string bytes = head.dump(-1, ' ', false, kReplace) + "\n";
    append(mesh.vertices, bytes);
    append(mesh.corners, bytes);
    append(mesh.polygon_end, bytes);
    return bytes;
  } catch (const Error& fault) {
    take_error(fault);
  } catch (const std::exception&) {
    take_error(no_memory);
  }
  return head.dump(-1, ' ', false, kReplace) + "\n";
}

RawMesh scene_from_bytes(std::string_view bytes) {
  const std::size_t end = bytes.find('\n');
  const auto head = nlohmann::json::parse(bytes.substr(0, end));
  bytes.remove_prefix(end + 1);
  if (head.contains("problem")) refuse(head["problem"], head["where"], head["hint"]);
  RawMesh mesh;
  take(mesh.vertices, head["vertices"], bytes);
  take(mesh.corners, head["corners"], bytes);
  take(mesh.polygon_end, head["polygons"], bytes);
  mesh.dropped_polygons = head["dropped"];
  mesh.notes = head["notes"];
  mesh.metres_per_unit = head["metres_per_unit"];
  return mesh;
}

// Reads in a process of its own; nothing if that crashes.
std::optional<RawMesh> read_apart(std::string_view bytes, const std::string& name,
                                  MeshFormat format, const std::string& node) {
  const auto read = [&] { return read_scene(bytes, name, format, node); };
  // A second for each megabyte, and what a busy machine may need for the smallest.
  const ChildLimits limits{file::most_memory(bytes.size()),
                           4 + static_cast<unsigned>(bytes.size() / 1'000'000)};
  const Error no_memory(ErrorKind::refused,
                        "assimp asks for more than " + std::to_string(limits.memory / 1'000'000) +
                            " MB of memory for this " + name_of(format) + " file; it is damaged",
                        name, kSaveAgain);
  const ChildResult result = run_in_child([&] { return scene_as_bytes(read, no_memory); }, limits);
  if (result.end == ChildResult::End::crashed) return std::nullopt;
  if (result.end != ChildResult::End::returned) {
    refuse(std::string("assimp, the library that reads ") + name_of(format) +
               " here, takes more than " + std::to_string(limits.seconds) +
               " s of the processor for this file; it is damaged",
           name, kSaveAgain);
  }
  return scene_from_bytes(result.bytes);
}

// Reads glTF: with its skins where assimp can, otherwise without.
std::optional<RawMesh> read_gltf(std::string_view bytes, const std::string& name,
                                 const std::string& node) {
  const GltfHeader header = gltf_header(bytes, name, node);
  if (header.plain) bytes = *header.plain;
  auto mesh = header.keeps_skin ? read_apart(bytes, name, MeshFormat::gltf, node) : std::nullopt;
  if (!mesh) {
    mesh = read_apart(without_skins(bytes), name, MeshFormat::gltf, node);
    if (mesh && header.has_skin) mesh->notes.push_back(kSkinIsNotApplied);
  }
  if (mesh) mesh->notes.insert(mesh->notes.end(), header.notes.begin(), header.notes.end());
  return mesh;
}

}  // namespace

RawMesh parse_scene(std::string_view bytes, const std::string& name, MeshFormat format,
                    const std::string& node) {
  auto mesh = format == MeshFormat::gltf ? read_gltf(bytes, name, node)
                                         : read_apart(bytes, name, format, node);
  if (!mesh) {
    refuse(std::string("assimp, the library that reads ") + name_of(format) +
               " here, crashed on this file",
           name, kSaveAgain);
  }
  mesh->format = format;
  mesh->name = name;
  return *std::move(mesh);
}

}  // namespace vpm
