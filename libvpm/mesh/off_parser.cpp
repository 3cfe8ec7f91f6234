// Object File Format as text: a keyword, three counts, one vertex and one face per line.

#include <algorithm>
#include <bit>
#include <cstring>
#include <optional>

#include "libvpm/core/error.h"
#include "libvpm/mesh/mesh_parsers.h"
#include "libvpm/mesh/text_lines.h"

namespace vpm {
namespace {

// True for keywords whose vertices begin with x, y, z; texture coordinates, colours and normals may
// follow.
bool is_plain_keyword(std::string_view word) {
  for (const char* const prefix : {"ST", "C", "N"}) {
    if (word.starts_with(prefix)) word.remove_prefix(std::string_view(prefix).size());
  }
  return word == "OFF";
}

void read_vertices(TextLines& lines, std::int64_t count, RawMesh& mesh) {
  mesh.vertices.reserve(static_cast<std::size_t>(count));
  for (std::int64_t k = 0; k < count; ++k) {
    lines.require_line("a vertex");
    mesh.vertices.push_back(lines.point());
  }
}

void read_faces(TextLines& lines, std::int64_t count, RawMesh& mesh) {
  mesh.polygon_end.reserve(static_cast<std::size_t>(count));
  const auto vertices = static_cast<std::int64_t>(mesh.vertices.size());
  for (std::int64_t k = 0; k < count; ++k) {
    lines.require_line("a face");
    const std::int64_t corners = lines.integer("the face's number of corners");
    if (corners < 3) lines.refuse_here("a face has fewer than 3 corners");
    for (std::int64_t c = 0; c < corners; ++c) {
      const std::int64_t index = lines.integer("a vertex index");
      if (index < 0 || index >= vertices) {
        lines.refuse_here("vertex index " + std::to_string(index) +
                          " is out of range; the header says " + std::to_string(vertices) +
                          " vertices, counted from 0");
      }
      mesh.corners.push_back(static_cast<std::uint32_t>(index));
    }
    mesh.polygon_end.push_back(mesh.corners.size());
  }
}

}  // namespace

bool looks_like_off(std::string_view text) {
  TextLines lines(text.substr(0, 65536), "", '#');
  return lines.next_line() && lines.word().ends_with("OFF");
}

RawMesh parse_off(std::string_view text, const std::string& name) {
  RawMesh mesh;
  mesh.format = MeshFormat::off;
  mesh.name = name;
  TextLines lines(text, name, '#');
  lines.require_line("the keyword OFF");
  const std::string_view keyword = lines.word();
  if (!is_plain_keyword(keyword)) lines.refuse_here("expected the keyword OFF (three coordinates)");
  const std::string_view first = lines.word();
  if (first == "BINARY") {
    if (keyword != "OFF")
      lines.refuse_here("binary OFF is read with three coordinates only; save it as text");
    return parse_off_binary(text.substr(lines.offset()), name);
  }
  if (!first.empty()) lines.refuse_here("the counts must follow on a line of their own");
  lines.require_line("the counts of vertices and faces");
  const std::int64_t vertices = lines.integer("the number of vertices");
  const std::int64_t faces = lines.integer("the number of faces");
  if (vertices < 0 || faces < 0) lines.refuse_here("a count is negative");
  // A vertex takes at least "0 0 0\n", a face "3 0 1 2\n".
  check_header_counts(
      name, std::to_string(vertices) + " vertices and " + std::to_string(faces) + " faces",
      6.0 * static_cast<double>(vertices) + 8.0 * static_cast<double>(faces) - 1, text.size());
  read_vertices(lines, vertices, mesh);
  read_faces(lines, faces, mesh);
  return mesh;
}

// Binary OFF. Files state neither byte order nor colours of faces: Geomview writes big-endian with
// a count of colour components after each face, OpenMesh little-endian without. The variant that
// uses up the file is taken.

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
  if (corners < 3 || !words.has(corners)) return false;
  for (std::uint32_t k = 0; k < corners; ++k) {
    mesh.corners.push_back(words.integer());
    if (mesh.corners.back() >= vertices) return false;
  }
  mesh.polygon_end.push_back(mesh.corners.size());
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
  if (!words.has(3 * std::uint64_t{vertices} + 4 * std::uint64_t{faces})) return std::nullopt;
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
