#include "libvpm/mesh/scene_header.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <utility>

#include "libvpm/core/error.h"
#include "libvpm/file/text.h"

namespace vpm {
namespace {

constexpr std::size_t kLooked = 1 << 16;  // bytes in which the header of a model stands
constexpr std::string_view kBlank = " \t\r\n";

// Returns the value of an attribute of the first element of the name; nothing where it has none.
std::optional<std::string_view> attribute_of(std::string_view xml, std::string_view element,
                                             std::string_view attribute) {
  for (std::size_t at = xml.find(element); at != xml.npos; at = xml.find(element, at + 1)) {
    const std::size_t after = at + element.size();
    const bool is_element = at > 0 && (xml[at - 1] == '<' || xml[at - 1] == ':') &&
                            after < xml.size() && kBlank.find(xml[after]) != kBlank.npos;
    if (!is_element) continue;
    const std::string_view tag = xml.substr(after, xml.find('>', after) - after);
    for (std::size_t name = tag.find(attribute); name != tag.npos;
         name = tag.find(attribute, name + 1)) {
      const std::size_t equals = tag.find_first_not_of(kBlank, name + attribute.size());
      if (name == 0 || kBlank.find(tag[name - 1]) == kBlank.npos || equals == tag.npos ||
          tag[equals] != '=')
        continue;
      const std::size_t quote = tag.find_first_not_of(kBlank, equals + 1);
      if (quote == tag.npos || (tag[quote] != '"' && tag[quote] != '\'')) return std::nullopt;
      const std::size_t end = tag.find(tag[quote], quote + 1);
      if (end == tag.npos) return std::nullopt;
      return tag.substr(quote + 1, end - quote - 1);
    }
    return std::nullopt;
  }
  return std::nullopt;
}

// Returns a number of little-endian bytes, 0 beyond the end.
std::uint32_t number_at(std::string_view bytes, std::size_t at, std::size_t size) {
  std::uint32_t value = 0;
  for (std::size_t k = size; k-- > 0;)
    value = value << 8 | (at + k < bytes.size() ? static_cast<unsigned char>(bytes[at + k]) : 0U);
  return value;
}

// Returns up to kLooked bytes of a deflated stream's beginning.
std::string inflated(std::string_view packed) {
  std::string text(kLooked, '\0');
  z_stream stream{};
  if (::inflateInit2(&stream, -MAX_WBITS) != Z_OK) return "";
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));
  stream.avail_in = static_cast<uInt>(std::min<std::size_t>(packed.size(), UINT32_MAX));
  stream.next_out = reinterpret_cast<Bytef*>(text.data());
  stream.avail_out = static_cast<uInt>(text.size());
  ::inflate(&stream, Z_SYNC_FLUSH);
  text.resize(text.size() - stream.avail_out);
  ::inflateEnd(&stream);
  return text;
}

// Returns the beginning of an entry of a zip archive, given the place of its record in the central
// directory; empty if it is damaged.
std::string entry_at(std::string_view zip, std::size_t record) {
  constexpr std::size_t kLocalSize = 30;
  const std::uint32_t method = number_at(zip, record + 10, 2),
                      size = number_at(zip, record + 20, 4);
  const std::size_t local = number_at(zip, record + 42, 4);
  const std::size_t begin =
      local + kLocalSize + number_at(zip, local + 26, 2) + number_at(zip, local + 28, 2);
  if (begin >= zip.size()) return "";
  const std::string_view packed = zip.substr(begin, size);
  return method == 0 ? std::string(packed.substr(0, kLooked)) : inflated(packed);
}

// Returns the beginning of the model in a 3MF archive; empty if there is none. Where parts of the
// model are files of their own, the main one has the usual name.
std::string model_in(std::string_view zip) {
  constexpr std::string_view kRecord{"PK\x01\x02", 4};
  constexpr std::size_t kRecordSize = 46, kMostTried = 64;
  std::size_t model = zip.npos, tried = 0;
  for (std::size_t at = zip.find(kRecord); at != zip.npos && tried < kMostTried;
       at = zip.find(kRecord, at + 1), ++tried) {
    const std::string_view rest = zip.substr(std::min(at + kRecordSize, zip.size()));
    const std::string path = file::in_lower_case(rest.substr(0, number_at(zip, at + 28, 2)));
    if (path == "3d/3dmodel.model") return entry_at(zip, at);
    if (path.ends_with(".model")) model = at;
  }
  return model == zip.npos ? "" : entry_at(zip, model);
}

// Returns the JSON of a glTF file, which is the first chunk of a binary one.
std::string_view json_of(std::string_view gltf) {
  constexpr std::size_t kHeader = 20;
  if (!gltf.starts_with("glTF")) return gltf;
  return gltf.size() < kHeader ? "" : gltf.substr(kHeader, number_at(gltf, 12, 4));
}

// True for extensions that say how a surface looks, or what stands beside it, and for the
// compression that assimp may unpack; where it cannot, it says so.
bool is_readable(const std::string& extension) {
  if (extension == "KHR_draco_mesh_compression") return true;
  const std::string name = file::in_lower_case(extension);
  for (const char* const part : {"material", "texture", "light", "image", "xmp", "audio"})
    if (name.find(part) != name.npos) return true;
  return false;
}

}  // namespace

std::optional<double> collada_unit(std::string_view text) {
  const auto word = attribute_of(text.substr(0, kLooked), "unit", "meter");
  const auto metres = word ? file::to_number(*word) : std::nullopt;
  return metres && *metres > 0 && std::isfinite(*metres) ? metres : std::nullopt;
}

std::optional<NamedUnit> threemf_unit(std::string_view bytes, const std::string& name) {
  const std::string model = model_in(bytes);
  if (model.empty())
    refuse("its archive is damaged: no 3D model can be unpacked from it", name,
           "save it again, or as OBJ, PLY or STL");
  const auto unit = attribute_of(model, "model", "unit");
  if (!unit) return std::nullopt;
  constexpr std::array<std::pair<const char*, double>, 6> kUnits = {{{"micron", 1e-6},
                                                                     {"millimeter", 0.001},
                                                                     {"centimeter", 0.01},
                                                                     {"inch", 0.0254},
                                                                     {"foot", 0.3048},
                                                                     {"meter", 1}}};
  for (const auto& [known, metres] : kUnits)
    if (*unit == known) return NamedUnit{known, metres};
  refuse("its unit '" + file::shown(*unit) +
             "' is none of 3MF: micron, millimeter, centimeter, inch, foot or meter",
         name);
}

void check_gltf_extensions(std::string_view bytes, const std::string& name) {
  const auto content = nlohmann::json::parse(json_of(bytes), nullptr, false);
  if (!content.is_object()) return;  // assimp says what is wrong
  const auto required = content.find("extensionsRequired");
  if (required == content.end() || !required->is_array()) return;
  for (const auto& extension : *required) {
    if (!extension.is_string() || is_readable(extension.get<std::string>())) continue;
    refuse("it requires the glTF extension " + file::shown(extension.get<std::string>()) +
               ", which is not read here",
           name, "save it without compression, quantization and instancing, or as OBJ, PLY or STL");
  }
}

std::string without_skins(std::string_view gltf) {
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
