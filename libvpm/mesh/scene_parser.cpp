// Files of scenes (COLLADA, glTF, 3MF, FBX) by assimp: nodes with transforms, which hold meshes.
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
#include <map>
#include <new>
#include <nlohmann/json.hpp>
#include <system_error>

#include "libvpm/core/error.h"
#include "libvpm/file/stream.h"
#include "libvpm/file/text.h"
#include "libvpm/mesh/child_process.h"
#include "libvpm/mesh/mesh_parsers.h"
#include "libvpm/mesh/scene_header.h"

namespace vpm {
namespace {

constexpr std::size_t kNamesShown = 12;
constexpr const char* kSaveAgain = "save it again, or as OBJ, PLY or STL";

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

// Opens one file from memory, and those that it names from where they are.
class FileInMemory : public Assimp::DefaultIOSystem {
 public:
  FileInMemory(std::string path, std::string_view bytes) : path_(std::move(path)), bytes_(bytes) {}

  Assimp::IOStream* Open(const char* path, const char* mode) override {
    if (path != path_) return DefaultIOSystem::Open(path, mode);
    return new Assimp::MemoryIOStream(reinterpret_cast<const std::uint8_t*>(bytes_.data()),
                                      bytes_.size());
  }

 private:
  std::string path_;
  std::string_view bytes_;
};

// A glTF file may name others beside it, so what is a file is read by its path.
const aiScene* import_scene(Assimp::Importer& importer, std::string_view bytes,
                            const std::string& name, MeshFormat format) {
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_USE_COLLADA_NAMES, true);
  importer.SetPropertyBool(AI_CONFIG_IMPORT_FBX_PRESERVE_PIVOTS, false);
  const bool is_gltf_text = format == MeshFormat::gltf && !bytes.starts_with("glTF");
  std::error_code fault;
  if (is_gltf_text && std::filesystem::is_regular_file(name, fault)) {
    importer.SetIOHandler(new FileInMemory(name, bytes));
    return importer.ReadFile(name, 0);
  }
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
  std::size_t parent, end;  // index of the parent, its own for the root; one after the last below
  bool holds_faces;         // itself, or a node below
};

// Returns all nodes, each before those below it.
std::vector<PlacedNode> placed_nodes(const aiScene& scene) {
  std::vector<PlacedNode> nodes;
  std::vector<PlacedNode> open{{scene.mRootNode, scene.mRootNode->mTransformation, 0, 0, false}};
  while (!open.empty()) {
    const PlacedNode here = open.back();
    open.pop_back();
    const std::size_t at = nodes.size();
    nodes.push_back(here);
    nodes[at].end = at + 1;
    nodes[at].holds_faces = has_faces(scene, *here.node);
    for (unsigned k = here.node->mNumChildren; k-- > 0;) {
      const aiNode* const child = here.node->mChildren[k];
      open.push_back({child, here.to_world * child->mTransformation, at, 0, false});
    }
  }
  for (std::size_t k = nodes.size(); k-- > 1;) {
    PlacedNode& parent = nodes[nodes[k].parent];
    parent.end = std::max(parent.end, nodes[k].end);
    parent.holds_faces = parent.holds_faces || nodes[k].holds_faces;
  }
  return nodes;
}

// Chooses among the nodes that hold faces. Where several have one name, they are called NAME[1],
// NAME[2], ... in the order of the file.
class NodeChoice {
 public:
  NodeChoice(const aiScene& scene, const std::string& file)
      : scene_(scene), file_(file), nodes_(placed_nodes(scene)) {
    for (std::size_t k = 0; k < nodes_.size(); ++k)
      if (nodes_[k].holds_faces) named_[nodes_[k].node->mName.C_Str()].push_back(k);
  }

  // Returns those with faces of their own: all, or that of the given name and those below it.
  std::vector<std::size_t> choose(const std::string& name) const {
    const std::size_t top = name.empty() ? 0 : find(name);
    std::vector<std::size_t> chosen;
    for (std::size_t k = top; k < nodes_[top].end; ++k)
      if (has_faces(scene_, *nodes_[k].node)) chosen.push_back(k);
    return chosen;
  }

  const PlacedNode& operator[](std::size_t k) const { return nodes_[k]; }

  // Returns the names by which they are chosen.
  std::string names_of(const std::vector<std::size_t>& nodes) const {
    std::string names;
    for (std::size_t k = 0; k < std::min(nodes.size(), kNamesShown); ++k)
      names += (k > 0 ? ", " : "") + label_of(nodes[k]);
    return names + (nodes.size() > kNamesShown ? ", …" : "");
  }

 private:
  std::size_t find(const std::string& name) const {
    const auto found = named_.find(name);
    if (found == named_.end()) return find_numbered(name);
    const std::vector<std::size_t>& same = found->second;
    if (same.back() < nodes_[same[0]].end) return same[0];  // the others lie below it
    refuse(std::to_string(same.size()) + " nodes have the name '" + file::shown(name) + "'", file_,
           "give `node` one of " + names_of(same) + ", or the name of a node above");
  }

  std::size_t find_numbered(const std::string& name) const {
    const std::size_t bracket = name.rfind('[');
    const auto found = named_.find(name.substr(0, bracket));
    if (bracket != name.npos && name.ends_with(']') && found != named_.end()) {
      const auto number = file::to_count(name.substr(bracket + 1, name.size() - bracket - 2));
      if (number && *number >= 1 && *number <= found->second.size())
        return found->second[*number - 1];
    }
    refuse("it has no node '" + file::shown(name) + "'; nodes with faces: " + names_of(choose("")),
           file_);
  }

  std::string label_of(std::size_t k) const {
    const std::vector<std::size_t>& same = named_.at(nodes_[k].node->mName.C_Str());
    const std::string name = name_of(*nodes_[k].node);
    if (same.size() == 1) return name;
    const auto place = std::lower_bound(same.begin(), same.end(), k) - same.begin();
    return name + "[" + std::to_string(place + 1) + "]";
  }

  const aiScene& scene_;
  const std::string& file_;
  std::vector<PlacedNode> nodes_;
  std::map<std::string, std::vector<std::size_t>> named_;  // those that hold faces, in order
};

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

// How long a unit of the file is in metres, as told; the file may name none.
struct FileUnit {
  double metres;
  std::string words;
};

std::string text_of_metres(double metres) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g m", metres);
  return text;
}

// Returns the unit by which coordinates are to be multiplied; of COLLADA, assimp has done so.
FileUnit unit_of(const aiScene& scene, MeshFormat format, std::string_view bytes,
                 const std::string& name) {
  const auto told = [](double metres, const std::string& why) {
    return FileUnit{metres, "its unit is taken to be " + text_of_metres(metres) + why};
  };
  constexpr double kCentimetre = 0.01;
  float factor = 1;
  double factor64 = 1;
  switch (format) {
    case MeshFormat::dae: {
      const auto unit = collada_unit(bytes);
      if (!unit) return {1, "its coordinates are taken to be metres, as it names no unit"};
      return {1, "its unit of " + text_of_metres(*unit) + " was applied"};
    }
    case MeshFormat::threemf: {
      const auto unit = threemf_unit(bytes, name);
      if (!unit) return told(0.001, ", which 3MF has by default");
      return told(unit->metres, ", the " + unit->name + " that the file names");
    }
    case MeshFormat::fbx:
      if (scene.mMetaData != nullptr && scene.mMetaData->Get("UnitScaleFactor", factor))
        return told(kCentimetre * double{factor}, ", as the file says");
      if (scene.mMetaData != nullptr && scene.mMetaData->Get("UnitScaleFactor", factor64))
        return told(kCentimetre * factor64, ", as the file says");
      return told(kCentimetre, ", which FBX has by default");
    default:
      return {1, "its coordinates are metres"};
  }
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

// Reads by assimp; see parse_scene, which tells the mesh its format and name.
RawMesh read_scene(std::string_view bytes, const std::string& name, MeshFormat format,
                   const std::string& node) {
  RawMesh mesh;
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
  const NodeChoice choice(*scene, name);
  const std::vector<std::size_t> nodes = choice.choose(node);
  const FileUnit unit = unit_of(*scene, format, bytes, name);
  for (const std::size_t k : nodes) {
    const aiNode& placed = *choice[k].node;
    for (unsigned m = 0; m < placed.mNumMeshes; ++m)
      add_mesh(*scene->mMeshes[placed.mMeshes[m]], choice[k].to_world, mesh);
  }
  for (Vec3& p : mesh.vertices) p = unit.metres * p;
  mesh.notes.push_back(unit.words + "; transforms of nodes were applied; " +
                       up_axis(*scene, format, bytes) + " is up, as in the file");
  if (nodes.size() > 1) {
    mesh.notes.push_back("the meshes of " + std::to_string(nodes.size()) +
                         " nodes are joined: " + choice.names_of(nodes) + "; `node` chooses one");
  }
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
            {"notes", mesh.notes}};
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
  return mesh;
}

}  // namespace

RawMesh parse_scene(std::string_view bytes, const std::string& name, MeshFormat format,
                    const std::string& node) {
  std::string changed;
  if (format == MeshFormat::gltf) {
    check_gltf_extensions(bytes, name);
    changed = without_skins(bytes);
    bytes = changed;
  }
  const auto read = [&] { return read_scene(bytes, name, format, node); };
  // A second for each megabyte, and what a busy machine may need for the smallest.
  const ChildLimits limits{file::most_memory(bytes.size()),
                           4 + static_cast<unsigned>(bytes.size() / 1'000'000)};
  const Error no_memory(ErrorKind::refused,
                        "assimp asks for more than " + std::to_string(limits.memory / 1'000'000) +
                            " MB of memory for this " + name_of(format) + " file; it is damaged",
                        name, kSaveAgain);
  const ChildResult result = run_in_child([&] { return scene_as_bytes(read, no_memory); }, limits);
  if (result.end != ChildResult::End::returned) {
    refuse(std::string("assimp, the library that reads ") + name_of(format) + " here, " +
               (result.end == ChildResult::End::crashed
                    ? "crashed on this file"
                    : "takes more than " + std::to_string(limits.seconds) +
                          " s of the processor for this file; it is damaged"),
           name, kSaveAgain);
  }
  RawMesh mesh = scene_from_bytes(result.bytes);
  mesh.format = format;
  mesh.name = name;
  return mesh;
}

}  // namespace vpm
