// The JSON of glTF files: what they need, and what of them is not applied.
#include <algorithm>
#include <charconv>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <system_error>
#include <utility>
#include <vector>

#include "libvpm/core/error.h"
#include "libvpm/file/scalar_type.h"
#include "libvpm/file/stream.h"
#include "libvpm/file/text.h"
#include "libvpm/mesh/gltf_json.h"
#include "libvpm/mesh/gltf_nodes.h"
#include "libvpm/mesh/gltf_plain.h"
#include "libvpm/mesh/scene_header.h"

namespace vpm {
namespace {

using nlohmann::json;

void put_number(std::string& bytes, std::size_t at, std::size_t value) {
  for (std::size_t k = 0; k < 4; ++k) bytes[at + k] = static_cast<char>(value >> 8 * k & 0xFF);
}

// Returns the JSON of a glTF file, which is the first chunk of a binary one.
std::string_view json_of(std::string_view gltf) {
  constexpr std::size_t kHeader = 20;
  if (!gltf.starts_with("glTF")) return gltf;
  return gltf.size() < kHeader ? "" : gltf.substr(kHeader, file::unsigned_at(gltf, 12));
}

// Returns the binary data of a binary file, which is its second chunk.
std::string_view chunk_of(std::string_view gltf) {
  constexpr std::size_t kHeader = 20, kChunkHeader = 8;
  if (!gltf.starts_with("glTF")) return "";
  const std::size_t at = kHeader + std::size_t{file::unsigned_at(gltf, 12)};
  if (at + kChunkHeader > gltf.size()) return "";
  return gltf.substr(at + kChunkHeader, file::unsigned_at(gltf, at));
}

// Says what follows a binary file, such as a second one that `cat` has joined to it.
void note_rest(std::string_view gltf, GltfHeader& header) {
  constexpr std::size_t kLengthAt = 8, kHeader = 12, kMostPadding = 3;
  if (!gltf.starts_with("glTF") || gltf.size() < kHeader) return;
  const std::size_t length = file::unsigned_at(gltf, kLengthAt);
  if (gltf.size() > length + kMostPadding) {
    header.notes.push_back("the " + std::to_string(gltf.size() - length) +
                           " bytes after the length in its header are not read");
  }
}

// True for extensions that are read, that say how a surface looks or what stands beside it, and for
// the compression that assimp may unpack; where it cannot, it says so.
bool is_readable(const std::string& extension) {
  for (const char* const read : {"KHR_draco_mesh_compression", "KHR_mesh_quantization",
                                 "EXT_mesh_gpu_instancing", "KHR_node_visibility"})
    if (extension == read) return true;
  const std::string name = file::in_lower_case(extension);
  for (const char* const part : {"material", "texture", "light", "image", "xmp", "audio"})
    if (name.find(part) != name.npos) return true;
  return false;
}

constexpr const char* kSaveUncompressed = "save it without compression, or as OBJ, PLY or STL";

void check_required(const json& content, const std::string& name) {
  for (const json& extension : member(content, "extensionsRequired")) {
    if (!extension.is_string() || is_readable(text_of(extension))) continue;
    refuse("it requires the glTF extension " + file::shown(text_of(extension)) +
               ", which is not read here",
           name, kSaveUncompressed);
  }
}

bool is_file(const std::filesystem::path& path) {
  std::error_code fault;
  return std::filesystem::is_regular_file(path, fault);
}

// Refuses a file whose buffers lie in files that are not there: assimp names them only, and of a
// pipe nobody knows where they are.
void check_buffers(const json& content, bool is_binary, const std::string& name) {
  constexpr const char* kOneFile = "save it as GLB, which is one file";
  const std::filesystem::path folder = std::filesystem::path(name).parent_path();
  bool has_chunk = is_binary;
  for (const json& buffer : member(content, "buffers")) {
    const std::string uri = text_of(member(buffer, "uri"));
    if (uri.empty() && !std::exchange(has_chunk, false)) {
      refuse(
          "the data of its meshes is not in the file in plain form, as with "
          "EXT_meshopt_compression",
          name, kSaveUncompressed);
    }
    has_chunk = false;
    if (uri.empty() || uri.starts_with("data:")) continue;
    const std::string needed = "it needs the file '" + file::shown(uri, 200) + "'";
    if (uri.find("://") != uri.npos) refuse(needed + ", which is not fetched", name, kOneFile);
    if (!is_file(name)) {
      refuse(needed + " beside it, whose folder a pipe does not tell", name,
             std::string("give the path of the glTF file, or ") + kOneFile);
    }
    if (is_file(folder / uri) || is_file(folder / percent_decoded(uri))) continue;
    refuse(needed + " beside it, which is not there", name,
           std::string("put it there, or ") + kOneFile);
  }
}

bool has_data(const json& content, const json& accessor) {
  return member(element(member(content, "accessors"), accessor), "bufferView").is_number_unsigned();
}

bool has_joints(const json& content, const json& skin) {
  const json& joints = member(skin, "joints");
  if (!joints.is_array() || joints.empty() ||
      !has_data(content, member(skin, "inverseBindMatrices")))
    return false;
  const json& nodes = member(content, "nodes");
  return std::all_of(joints.begin(), joints.end(),
                     [&](const json& joint) { return element(nodes, joint).is_object(); });
}

bool has_weights(const json& content, const json& mesh) {
  const json& primitives = member(mesh, "primitives");
  return std::all_of(primitives.begin(), primitives.end(), [&](const json& primitive) {
    const json& attributes = member(primitive, "attributes");
    return has_data(content, member(attributes, "JOINTS_0")) &&
           has_data(content, member(attributes, "WEIGHTS_0"));
  });
}

// Tells whether assimp can read the skins that nodes give their meshes: it crashes where matrices
// or weights are missing. Looks at a skin or mesh once, however many nodes have it.
void take_skins(const json& content, GltfHeader& header) {
  std::set<const json*> skins, meshes;
  for (const json& node : member(content, "nodes")) {
    if (member(node, "skin").is_null()) continue;
    header.has_skin = header.has_skin || !member(node, "mesh").is_null();
    skins.insert(&element(member(content, "skins"), member(node, "skin")));
    meshes.insert(&element(member(content, "meshes"), member(node, "mesh")));
  }
  header.keeps_skin = std::all_of(skins.begin(), skins.end(),
                                  [&](const json* skin) { return has_joints(content, *skin); }) &&
                      std::all_of(meshes.begin(), meshes.end(),
                                  [&](const json* mesh) { return has_weights(content, *mesh); });
  header.keeps_skin = header.keeps_skin && header.has_skin;
}

// True if a mesh or a node gives a morph target a weight.
bool has_morph(const json& content) {
  for (const char* const list : {"meshes", "nodes"})
    for (const json& holder : member(content, list))
      for (const json& weight : member(holder, "weights"))
        if (weight.is_number() && weight.get<double>() != 0) return true;
  return false;
}

// Returns the file with this JSON in place of its own.
std::string with_json(std::string_view gltf, const json& content) {
  constexpr std::size_t kHeader = 20, kLengthAt = 8, kJsonLengthAt = 12;
  std::string text = content.dump(-1, ' ', false, json::error_handler_t::replace);
  if (!gltf.starts_with("glTF")) return text;
  text.resize((text.size() + 3) / 4 * 4, ' ');
  const std::size_t before = json_of(gltf).size();
  std::string changed(gltf.substr(0, kHeader));
  put_number(changed, kLengthAt, file::unsigned_at(gltf, kLengthAt) - before + text.size());
  put_number(changed, kJsonLengthAt, text.size());
  return changed + text + std::string(gltf.substr(kHeader + before));
}

}  // namespace

std::string percent_decoded(std::string_view text) {
  std::string decoded;
  for (std::size_t k = 0; k < text.size(); ++k) {
    unsigned code = 0;
    const std::string_view digits = text.substr(k + 1, 2);
    const auto [end, fault] =
        std::from_chars(digits.data(), digits.data() + digits.size(), code, 16);
    const bool is_code = text[k] == '%' && digits.size() == 2 && fault == std::errc() &&
                         end == digits.data() + digits.size();
    decoded += is_code ? static_cast<char>(code) : text[k];
    if (is_code) k += 2;
  }
  return decoded;
}

GltfHeader gltf_header(std::string_view bytes, const std::string& name, const std::string& node) {
  GltfHeader header;
  json content = json::parse(json_of(bytes), nullptr, false);
  if (!content.is_object()) return header;  // assimp says what is wrong
  check_required(content, name);
  check_buffers(content, bytes.starts_with("glTF"), name);
  note_rest(bytes, header);
  const bool gets_scene = give_scene(content);
  if (gets_scene) header.notes.push_back("it has no scene, and so all of its nodes are read");
  const bool gets_names = name_nodes(content);
  const std::vector<std::string> hidden = hide_nodes(content, node, name);
  if (!hidden.empty())
    header.notes.push_back(std::to_string(hidden.size()) +
                           (hidden.size() == 1 ? " node is" : " nodes are") +
                           " left out as hidden (KHR_node_visibility): " + file::listed(hidden));
  take_skins(content, header);
  if (has_morph(content))
    header.notes.push_back(
        "its morph targets have weights, which are not applied: check its shape");
  header.plain = as_plain_gltf(content, chunk_of(bytes), name, file::most_memory(bytes.size()));
  if (!header.plain && (gets_scene || gets_names || !hidden.empty()))
    header.plain = with_json(bytes, content);
  return header;
}

std::string without_skins(std::string_view gltf) {
  constexpr std::string_view kBlank = " \t\r\n";
  std::string changed(gltf);
  const std::string_view json = json_of(gltf);
  const auto first = static_cast<std::size_t>(json.data() - gltf.data());
  for (const std::string_view key : {"\"skins\"", "\"skin\""}) {
    for (std::size_t at = json.find(key); at != json.npos; at = json.find(key, at + 1)) {
      const std::size_t colon = json.find_first_not_of(kBlank, at + key.size());
      if (colon != json.npos && json[colon] == ':') changed[first + at + 1] = '_';
    }
  }
  return changed;
}

}  // namespace vpm
