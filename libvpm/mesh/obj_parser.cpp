// Wavefront OBJ: v and f lines; other statements carry no polygons.
#include <charconv>

#include "libvpm/core/error.h"
#include "libvpm/file/text_lines.h"
#include "libvpm/mesh/mesh_parsers.h"

namespace vpm {
namespace {

// Keywords whose statements hold numbers, and may go on after a backslash. Statements with names
// may end in one that belongs to the name: "g C:\parts\".
constexpr std::string_view kWithNumbers[] = {
    "v",    "vt",   "vn",   "vp",   "f",  "fo",  "l",    "p",   "curv", "curv2", "surf",
    "parm", "trim", "hole", "scrv", "sp", "con", "bmat", "deg", "step", "ctech", "stech"};

// Returns the vertex of a corner "v", "v/vt", "v//vn" or "v/vt/vn", which counts from 1, or
// backwards from the last vertex so far.
std::uint32_t corner_vertex(const file::TextLines& lines, std::string_view word,
                            std::size_t so_far) {
  if (word.starts_with('+')) word.remove_prefix(1);
  const std::string_view digits = word.substr(0, word.find('/'));
  std::int64_t index = 0;
  const auto [stop, fault] = std::from_chars(digits.data(), digits.data() + digits.size(), index);
  if (fault == std::errc::invalid_argument || stop != digits.data() + digits.size())
    lines.refuse_here("a corner of the face is not a vertex index");
  const std::int64_t from_zero = index > 0 ? index - 1 : static_cast<std::int64_t>(so_far) + index;
  if (fault != std::errc() || index == 0 || from_zero < 0 ||
      from_zero >= static_cast<std::int64_t>(kMaxVertices)) {
    lines.refuse_here("vertex index " + file::shown(digits, 40) + " is out of range" +
                      (index == 0 ? "; OBJ counts from 1" : ""));
  }
  return static_cast<std::uint32_t>(from_zero);
}

// Returns the point of a line "v x y z", or, as the format says of "v x y z w", divided by w.
// Colours may follow in place of w.
Vec3 vertex(file::TextLines& lines, std::size_t& divided) {
  const Vec3 p = lines.point();
  if (lines.rest().empty()) return p;
  const std::string_view fourth = lines.word();
  if (fourth.empty() || !lines.word().empty()) return p;
  const double w = lines.to_number(fourth, "w");
  if (w == 1) return p;
  if (w == 0 || !is_finite(p / w)) lines.refuse_here("the vertex divided by its w is not finite");
  ++divided;
  return p / w;
}

}  // namespace

RawMesh parse_obj(std::string_view text, const std::string& name) {
  RawMesh mesh;
  mesh.format = MeshFormat::obj;
  mesh.name = name;
  std::uint32_t largest = 0;  // a face may name a later vertex
  std::size_t largest_line = 0;
  std::size_t divided = 0;
  file::TextLines lines(text, name, '#', {'\\', kWithNumbers});
  while (lines.next_line()) {
    const std::string_view keyword = lines.word();
    if (keyword == "v") {
      if (mesh.vertices.size() == kMaxVertices) lines.refuse_here("more than 2^32 - 2 vertices");
      mesh.vertices.push_back(vertex(lines, divided));
    } else if (keyword == "f") {
      for (std::string_view word = lines.word(); !word.empty(); word = lines.word()) {
        mesh.corners.push_back(corner_vertex(lines, word, mesh.vertices.size()));
        if (mesh.corners.back() >= largest) {
          largest = mesh.corners.back();
          largest_line = lines.line_number();
        }
      }
      mesh.end_polygon();
    }
  }
  if (!mesh.corners.empty() && largest >= mesh.vertices.size()) {
    refuse("line " + std::to_string(largest_line) + ": vertex index " +
               std::to_string(std::size_t{largest} + 1) + " is out of range; the file has " +
               std::to_string(mesh.vertices.size()) + " vertices",
           name);
  }
  note_division(divided, mesh);
  return mesh;
}

}  // namespace vpm
