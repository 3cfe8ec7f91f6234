#include "libvpm/mesh/gltf_plain.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <map>
#include <tuple>
#include <utility>
#include <vector>

#include "libvpm/core/error.h"
#include "libvpm/file/scalar_type.h"
#include "libvpm/file/stream.h"
#include "libvpm/file/text.h"
#include "libvpm/mesh/gltf_json.h"
#include "libvpm/mesh/scene_header.h"

namespace vpm {
namespace {

using nlohmann::json;

constexpr const char* kInstancing = "EXT_mesh_gpu_instancing";
constexpr const char* kDraco = "KHR_draco_mesh_compression";
constexpr std::uint64_t kFloat = 5126;

void put_number(std::string& bytes, std::uint64_t value) {
  for (std::size_t k = 0; k < 4; ++k) bytes += static_cast<char>(value >> 8 * k & 0xFF);
}

std::string from_base64(std::string_view text) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    const std::size_t digit = kDigits.find(c);
    if (digit == kDigits.npos) break;
    bits = bits << 6 | static_cast<std::uint32_t>(digit);
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes += static_cast<char>(bits >> count & 0xFF);
  }
  return bytes;
}

file::ScalarType type_of(std::uint64_t component) {
  switch (component) {
    case 5120:
      return {'I', 1};
    case 5121:
      return {'U', 1};
    case 5122:
      return {'I', 2};
    case 5123:
      return {'U', 2};
    case 5125:
      return {'U', 4};
    case kFloat:
      return {'F', 4};
    default:
      return {};
  }
}

bool is_of_integers(const json& accessor) {
  const json& type = member(accessor, "componentType");
  return type.is_number_unsigned() && type != kFloat;
}

// Makes the file plain, with all of its buffers in one.
class PlainGltf {
 public:
  PlainGltf(const json& content, std::string_view chunk, const std::string& name,
            std::uint64_t most_bytes)
      : content_(content), name_(name), most_(most_bytes) {
    join_buffers(chunk);
  }

  void make_floats();
  void make_instances();
  std::string as_glb() const;

 private:
  void join_buffers(std::string_view chunk);
  std::string bytes_of(const json& buffer, std::string_view chunk) const;
  std::vector<double> numbers(const json& accessor, std::size_t width) const;
  json as_floats(const json& index, std::size_t width);
  std::vector<json> instances_of(const json& attributes, const json& mesh) const;
  void take_instances(std::size_t node);
  [[noreturn]] void refuse_numbers(const std::string& why) const {
    refuse("the numbers of its meshes cannot be read: " + why, name_,
           "save it without compression, or as OBJ, PLY or STL");
  }

  json content_;
  const std::string& name_;
  std::uint64_t most_;
  std::string buffer_;
  std::map<std::uint64_t, std::size_t> floats_;  // accessors of floats by those of integers
};

std::string PlainGltf::bytes_of(const json& buffer, std::string_view chunk) const {
  const std::string uri = text_of(member(buffer, "uri"));
  if (uri.empty()) return std::string(chunk);
  if (uri.starts_with("data:")) {
    const std::size_t comma = uri.find(";base64,");
    return comma == uri.npos ? "" : from_base64(std::string_view(uri).substr(comma + 8));
  }
  const std::filesystem::path folder = std::filesystem::path(name_).parent_path();
  const bool is_there = std::filesystem::exists(folder / uri);
  return std::string(
      file::as_text(file::read_all((folder / (is_there ? uri : percent_decoded(uri))).string())));
}

void PlainGltf::join_buffers(std::string_view chunk) {
  std::vector<std::size_t> begins, sizes;
  for (const json& buffer : member(content_, "buffers")) {
    const std::string bytes = bytes_of(buffer, begins.empty() ? chunk : "");
    begins.push_back(buffer_.size());
    sizes.push_back(bytes.size());
    buffer_ += bytes;
    buffer_.resize((buffer_.size() + 3) / 4 * 4);
  }
  content_["buffers"] = json::array();
  if (!member(content_, "bufferViews").is_array()) return;
  for (json& view : content_["bufferViews"]) {
    const std::uint64_t buffer = count_of(member(view, "buffer")),
                        offset = count_of(member(view, "byteOffset")),
                        length = count_of(member(view, "byteLength"));
    if (buffer >= begins.size() || offset > sizes[buffer] || length > sizes[buffer] - offset)
      refuse_numbers("a part of a buffer lies beyond its end");
    view["byteOffset"] = begins[buffer] + offset;
    view["buffer"] = 0;
  }
}

// Returns the accessor's numbers, `width` of each element. Normalised integers are fractions.
std::vector<double> PlainGltf::numbers(const json& accessor, std::size_t width) const {
  const json& view = element(member(content_, "bufferViews"), member(accessor, "bufferView"));
  const file::ScalarType type = type_of(count_of(member(accessor, "componentType")));
  if (!view.is_object() || type.size == 0 || !member(accessor, "sparse").is_null())
    refuse_numbers("they are sparse, compressed or of no known type");
  const std::uint64_t count = count_of(member(accessor, "count")),
                      offset = count_of(member(accessor, "byteOffset")),
                      length = count_of(member(view, "byteLength")), size = type.size * width;
  const std::uint64_t told = count_of(member(view, "byteStride"));
  const std::uint64_t stride = told > 0 ? told : size;
  if (count == 0 || offset > length || size > length - offset ||
      (count - 1) > (length - offset - size) / stride)
    refuse_numbers("an accessor reaches beyond the end of its buffer");
  if (count * width * sizeof(double) > most_) refuse_numbers("they are too many");
  const json& is_normalized = member(accessor, "normalized");
  const double unit = type.kind == 'F' || is_normalized != true
                          ? 1
                          : std::ldexp(1, 8 * type.size - (type.kind == 'I' ? 1 : 0)) - 1;
  const std::byte* const bytes = reinterpret_cast<const std::byte*>(buffer_.data()) +
                                 count_of(member(view, "byteOffset")) + offset;
  std::vector<double> numbers;
  for (std::uint64_t k = 0; k < count; ++k) {
    for (std::size_t i = 0; i < width; ++i) {
      const double value =
          file::read_scalar(bytes + k * stride + i * type.size, type, false) / unit;
      numbers.push_back(unit > 1 ? std::max(value, -1.0) : value);
    }
  }
  return numbers;
}

// Returns the index of an accessor of the same numbers as floats, which stand at the buffer's end.
json PlainGltf::as_floats(const json& index, std::size_t width) {
  const json& accessor = element(member(content_, "accessors"), index);
  if (!is_of_integers(accessor)) return index;
  const auto [place, is_new] = floats_.try_emplace(index.get<std::uint64_t>(), 0);
  if (!is_new) return place->second;
  const std::vector<double> values = numbers(accessor, width);
  const std::size_t begin = buffer_.size();
  for (const double value : values)
    put_number(buffer_, std::bit_cast<std::uint32_t>(static_cast<float>(value)));
  if (buffer_.size() > most_) refuse_numbers("they are too many");
  content_["bufferViews"].push_back(
      {{"buffer", 0}, {"byteOffset", begin}, {"byteLength", buffer_.size() - begin}});
  content_["accessors"].push_back({{"bufferView", content_["bufferViews"].size() - 1},
                                   {"componentType", kFloat},
                                   {"count", values.size() / width},
                                   {"type", width == 3 ? "VEC3" : "VEC4"}});
  return place->second = content_["accessors"].size() - 1;
}

// Keeps of each mesh its faces and weights only: normals and the like, and morph targets, may be of
// integers, too.
void PlainGltf::make_floats() {
  if (!member(content_, "meshes").is_array()) return;
  for (json& mesh : content_["meshes"]) {
    if (!member(mesh, "primitives").is_array()) continue;
    for (json& primitive : mesh["primitives"]) {
      const json attributes = member(primitive, "attributes");
      const json& position = member(attributes, "POSITION");
      if (!attributes.is_object() || position.is_null()) continue;
      if (!member(member(primitive, "extensions"), kDraco).is_null()) {
        if (is_of_integers(element(member(content_, "accessors"), position)))
          refuse_numbers("they are compressed integers (" + std::string(kDraco) + ")");
        continue;
      }
      json kept = {{"POSITION", as_floats(position, 3)}};
      if (const json& joints = member(attributes, "JOINTS_0"); !joints.is_null())
        kept["JOINTS_0"] = joints;
      if (const json& weights = member(attributes, "WEIGHTS_0"); !weights.is_null())
        kept["WEIGHTS_0"] = as_floats(weights, 4);
      primitive["attributes"] = kept;
      primitive.erase("targets");
    }
  }
}

// Returns a node with the mesh for each instance that the attributes place.
std::vector<json> PlainGltf::instances_of(const json& attributes, const json& mesh) const {
  constexpr std::uint64_t kBytesOfNode = 1024;
  std::vector<json> instances;
  for (const auto& [attribute, key, width] : {std::tuple{"TRANSLATION", "translation", 3},
                                              {"ROTATION", "rotation", 4},
                                              {"SCALE", "scale", 3}}) {
    const json& index = member(attributes, attribute);
    if (index.is_null()) continue;
    const std::vector<double> values =
        numbers(element(member(content_, "accessors"), index), static_cast<std::size_t>(width));
    const std::size_t count = values.size() / static_cast<std::size_t>(width);
    if (member(content_, "nodes").size() + count > most_ / kBytesOfNode)
      refuse_numbers("its instances are too many");
    if (!instances.empty() && instances.size() != count)
      refuse_numbers("the places of a node's instances differ in number");
    instances.resize(count, {{"mesh", mesh}});
    for (std::size_t k = 0; k < count; ++k) {
      const auto first = values.begin() + static_cast<std::ptrdiff_t>(k) * width;
      instances[k][key] = std::vector<double>(first, first + width);
    }
  }
  return instances;
}

// Gives the node a child for each of its instances, which have its mesh.
void PlainGltf::take_instances(std::size_t node) {
  const json before = content_["nodes"][node];
  const json& attributes = member(member(member(before, "extensions"), kInstancing), "attributes");
  const json& mesh = member(before, "mesh");
  if (!attributes.is_object() || attributes.empty() || mesh.is_null()) return;
  if (!member(before, "skin").is_null()) refuse_numbers("a node with instances has a skin");
  json children = member(before, "children").is_array() ? before["children"] : json::array();
  for (json& instance : instances_of(attributes, mesh)) {
    instance["name"] =
        text_of(member(before, "name")) + " instance " + std::to_string(children.size() + 1);
    children.push_back(content_["nodes"].size());
    content_["nodes"].push_back(std::move(instance));
  }
  json& after = content_["nodes"][node];
  after.erase("mesh");
  after.erase("extensions");
  after["children"] = children;
}

void PlainGltf::make_instances() {
  const std::size_t count = member(content_, "nodes").size();
  for (std::size_t node = 0; node < count; ++node) take_instances(node);
}

std::string PlainGltf::as_glb() const {
  json content = content_;
  content["buffers"] = json::array({{{"byteLength", buffer_.size()}}});
  for (const char* const unused : {"extensionsRequired", "animations", "materials", "textures",
                                   "images", "samplers", "extensions"})
    content.erase(unused);
  std::string text = content.dump(-1, ' ', false, json::error_handler_t::replace);
  text.resize((text.size() + 3) / 4 * 4, ' ');
  std::string bytes = "glTF";
  for (const std::uint64_t number :
       {std::uint64_t{2}, 28 + text.size() + buffer_.size(), text.size()})
    put_number(bytes, number);
  bytes += "JSON" + text;
  put_number(bytes, buffer_.size());
  return bytes + std::string("BIN\0", 4) + buffer_;
}

}  // namespace

std::optional<std::string> as_plain_gltf(const json& content, std::string_view chunk,
                                         const std::string& name, std::uint64_t most_bytes) {
  const json& nodes = member(content, "nodes");
  const bool has_instances = std::any_of(nodes.begin(), nodes.end(), [](const json& node) {
    return !member(member(node, "extensions"), kInstancing).is_null();
  });
  bool has_integers = false;
  for (const json& mesh : member(content, "meshes")) {
    for (const json& primitive : member(mesh, "primitives")) {
      for (const char* const key : {"POSITION", "WEIGHTS_0"}) {
        const json& index = member(member(primitive, "attributes"), key);
        has_integers = has_integers || is_of_integers(element(member(content, "accessors"), index));
      }
    }
  }
  if (!has_instances && !has_integers) return std::nullopt;
  PlainGltf plain(content, chunk, name, most_bytes);
  plain.make_floats();
  plain.make_instances();
  return plain.as_glb();
}

}  // namespace vpm
