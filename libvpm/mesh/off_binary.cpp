// Object File Format as binary. Files state neither byte order nor colours of faces: Geomview
// writes big-endian with a count of colour components after each face, OpenMesh little-endian
// without. The variant that uses up the file is taken.

#include <algorithm>
#include <bit>
#include <cstring>
#include <optional>

#include "libvpm/core/error.h"
#include "libvpm/mesh/mesh_parsers.h"

namespace vpm {
namespace {

constexpr std::size_t kWord = 4;

class Words {
 public:
  Words(std::string_view bytes, bool big_endian) : bytes_(bytes), swap_(big_endian) {
    static_assert(std::endian::native == std::endian::little);
  }
  bool has(std::uint64_t words) const { return words <= (bytes_.size() - at_) / kWord; }
  bool at_end() const { return at_ == bytes_.size(); }
  std::uint32_t integer() {  // needs has(1)
    char word[kWord];
    std::memcpy(word, bytes_.data() + at_, kWord);
    if (swap_) std::reverse(word, word + kWord);
    at_ += kWord;
    return std::bit_cast<std::uint32_t>(word);
  }
  double number() { return double{std::bit_cast<float>(integer())}; }
  void skip(std::uint64_t words) { at_ += kWord * words; }

 private:
  std::string_view bytes_;
  bool swap_;
  std::size_t at_ = 0;
};

bool read_face(Words& words, std::uint32_t vertices, bool has_colors, RawMesh& mesh) {
  if (!words.has(1)) return false;
  const std::uint32_t corners = words.integer();
  if (!words.has(corners)) return false;
  for (std::uint32_t k = 0; k < corners; ++k) {
    mesh.corners.push_back(words.integer());
    if (mesh.corners.back() >= vertices) return false;
  }
  mesh.end_polygon();
  if (!has_colors) return true;
  if (!words.has(1)) return false;
  const std::uint32_t components = words.integer();
  if (!words.has(components)) return false;
  words.skip(components);
  return true;
}

std::optional<RawMesh> attempt(std::string_view body, bool big_endian, bool has_colors) {
  Words words(body, big_endian);
  if (!words.has(3)) return std::nullopt;
  const std::uint32_t vertices = words.integer(), faces = words.integer();
  words.skip(1);  // edge count
  if (!words.has(3 * std::uint64_t{vertices} + std::uint64_t{faces})) return std::nullopt;
  RawMesh mesh;
  for (std::uint32_t k = 0; k < vertices; ++k) {
    const double x = words.number(), y = words.number(), z = words.number();
    mesh.vertices.push_back({x, y, z});
  }
  for (std::uint32_t k = 0; k < faces; ++k) {
    if (!read_face(words, vertices, has_colors, mesh)) return std::nullopt;
  }
  return words.at_end() ? std::optional(std::move(mesh)) : std::nullopt;
}

}  // namespace

RawMesh parse_off_binary(std::string_view body, const std::string& name) {
  for (const bool big_endian : {true, false}) {
    for (const bool has_colors : {true, false}) {
      std::optional<RawMesh> mesh = attempt(body, big_endian, has_colors);
      if (!mesh) continue;
      for (const Vec3& p : mesh->vertices) {
        if (!is_finite(p)) refuse("a coordinate is not finite", name);
      }
      mesh->format = MeshFormat::off;
      mesh->name = name;
      return *std::move(mesh);
    }
  }
  refuse("the counts of this binary OFF file do not fit its " + std::to_string(body.size()) +
             " bytes in either byte order; it is truncated or damaged",
         name);
}

}  // namespace vpm
