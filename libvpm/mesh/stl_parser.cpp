// Stereolithography: each triangle has its own three corners. Facet normals are ignored; the order
// of corners tells the outside.
#include <algorithm>
#include <bit>
#include <cstring>
#include <optional>

#include "libvpm/core/error.h"
#include "libvpm/file/text_lines.h"
#include "libvpm/mesh/mesh_parsers.h"

namespace vpm {
namespace {

static_assert(std::endian::native == std::endian::little, "binary STL is copied as it is stored");

constexpr std::size_t kHeaderBytes = 80;
constexpr std::size_t kFacetsAt = 84;     // after the header and the count
constexpr std::size_t kFacetBytes = 50;   // normal, three corners, attribute
constexpr std::size_t kCornersAt = 12;    // within a facet, after the normal
constexpr std::size_t kAttributeAt = 48;  // within a facet

std::string counted(std::size_t count, const char* thing) {
  return std::to_string(count) + " " + thing + (count == 1 ? "" : "s");
}

// Returns the count of triangles of the binary file that begins at `at`; 0 if none can.
std::uint32_t count_at(std::string_view bytes, std::size_t at) {
  std::uint32_t count = 0;
  if (at <= bytes.size() && bytes.size() - at >= kFacetsAt)
    std::memcpy(&count, bytes.data() + at + kHeaderBytes, sizeof count);
  return count;
}

std::size_t attribute_at(std::string_view bytes, std::size_t facet) {
  std::uint16_t attribute = 0;
  std::memcpy(&attribute, bytes.data() + facet + kAttributeAt, sizeof attribute);
  return attribute;
}

// Places of a binary file's facets, and what is to be said of how they were found.
struct Facets {
  std::vector<std::size_t> at;
  std::string note, doubt;
};

void add_facets(std::size_t begin, std::size_t count, std::vector<std::size_t>& at) {
  for (std::size_t k = 0; k < count; ++k) at.push_back(begin + kFacetBytes * k);
}

bool has_binary_size(std::string_view bytes) {
  return bytes.size() >= kFacetsAt &&
         bytes.size() == kFacetsAt + kFacetBytes * std::size_t{count_at(bytes, 0)};
}

// Returns the facets if the file is several binary files, one after the other.
std::optional<Facets> joined_files(std::string_view bytes) {
  std::vector<std::size_t> begins;
  std::size_t at = 0;
  while (at < bytes.size()) {
    const std::size_t count = count_at(bytes, at);
    if (count == 0 || count > (bytes.size() - at - kFacetsAt) / kFacetBytes) return std::nullopt;
    begins.push_back(at);
    at += kFacetsAt + kFacetBytes * count;
  }
  if (begins.size() < 2) return std::nullopt;
  Facets facets;
  for (const std::size_t begin : begins)
    add_facets(begin + kFacetsAt, count_at(bytes, begin), facets.at);
  facets.note = counted(begins.size(), "STL file") + " stand one after the other; all were read";
  return facets;
}

// Returns the facets if each is followed by as many bytes as its attribute says.
std::optional<Facets> with_payload(std::string_view bytes) {
  const std::size_t count = count_at(bytes, 0);
  if (count == 0 || count > (bytes.size() - kFacetsAt) / kFacetBytes) return std::nullopt;
  Facets facets;
  std::size_t at = kFacetsAt;
  for (std::size_t k = 0; k < count; ++k) {
    if (bytes.size() - at < kFacetBytes) return std::nullopt;
    const std::size_t payload = attribute_at(bytes, at);
    if (bytes.size() - at - kFacetBytes < payload) return std::nullopt;
    facets.at.push_back(at);
    at += kFacetBytes + payload;
  }
  if (at != bytes.size()) return std::nullopt;
  facets.note = counted(bytes.size() - kFacetsAt - kFacetBytes * count, "byte") +
                " of attributes between the triangles were passed over";
  return facets;
}

// Finds the facets of a file whose count does not fit its size.
Facets facets_by_size(std::string_view bytes, const std::string& name) {
  const std::size_t count = count_at(bytes, 0);
  const std::size_t held = (bytes.size() - kFacetsAt) / kFacetBytes,
                    rest = (bytes.size() - kFacetsAt) % kFacetBytes;
  if (rest != 0 && count == 0) {
    refuse("the header says 0 triangles, and " + counted(kFacetBytes * held + rest, "byte") +
               " follow, which are no whole number of triangles",
           name);
  }
  if (rest != 0 && count > held) {
    file::check_header_counts(name, counted(count, "triangle"),
                              static_cast<double>(kFacetsAt) +
                                  static_cast<double>(kFacetBytes) * static_cast<double>(count),
                              bytes.size());
  }
  Facets facets;
  add_facets(kFacetsAt, rest == 0 ? held : count, facets.at);
  if (rest != 0) {
    facets.note = counted(bytes.size() - kFacetsAt - kFacetBytes * count, "byte") +
                  " after the last of " + counted(count, "triangle") + " were passed over";
    return facets;
  }
  const std::string says = "the header says " + counted(count, "triangle");
  facets.note = says + ", but the file has " + std::to_string(held) + ", which were all read";
  if (count > held)
    facets.doubt = says + ", but the file has " + std::to_string(held) + " and may be truncated";
  return facets;
}

Facets find_facets(std::string_view bytes, const std::string& name) {
  if (has_binary_size(bytes)) {
    Facets facets;
    add_facets(kFacetsAt, count_at(bytes, 0), facets.at);
    return facets;
  }
  if (std::optional<Facets> facets = joined_files(bytes)) return *std::move(facets);
  if (std::optional<Facets> facets = with_payload(bytes)) return *std::move(facets);
  return facets_by_size(bytes, name);
}

bool looks_like_ascii(std::string_view bytes) {
  constexpr std::size_t kLooked = 4096;  // a "solid" line, then "facet" or at once "endsolid"
  const std::string_view start = file::without_padding(bytes).substr(0, kLooked);
  const std::size_t word = start.find_first_not_of(" \t\r\n");
  return word != std::string_view::npos && file::in_lower_case(start.substr(word, 5)) == "solid" &&
         start.find('\0') == std::string_view::npos;
}

// True if all bytes up to the first facet are text. Read as a count, four characters promise more
// than 10^8 triangles.
bool begins_as_text(std::string_view bytes) {
  const std::string_view start = bytes.substr(0, kFacetsAt);
  return !has_binary_size(bytes) && std::all_of(start.begin(), start.end(), [](char c) {
    return c == '\t' || c == '\n' || c == '\r' || (c >= ' ' && c <= '~');
  });
}

void add_corner(RawMesh& mesh, Vec3 p) {
  mesh.corners.push_back(static_cast<std::uint32_t>(mesh.vertices.size()));
  mesh.vertices.push_back(p);
}

// Reads ASCII files by words, wherever lines end. Only names end with their line.
class Text {
 public:
  Text(std::string_view text, RawMesh& mesh)
      : lines_(file::without_padding(text), mesh.name, 0), mesh_(mesh) {
    lines_.cross_lines(true);
  }

  void parse() {
    std::size_t line = 0;  // counts to the word before
    for (std::string_view word = lines_.word(); !word.empty(); word = lines_.word()) {
      const bool begins_line = lines_.line_number() != line;
      // Words after a statement are passed over: a normal, which may be no number, or a colour.
      if (!take(word) && begins_line && !is_of_normal(word))
        lines_.refuse_here("not a statement of an STL file");
      line = lines_.line_number();
    }
    finish();
  }

 private:
  // Takes the statement that begins with the word; false if none does.
  bool take(std::string_view word) {
    if (file::is_word(word, "vertex")) {
      add_vertex();
    } else if (file::is_word(word, "facet")) {
      begin_facet();
    } else if (file::is_word(word, "end")) {  // "end loop", as some programs write
      return take_end(lines_.word());
    } else if (word.size() > 3 && file::is_word(word.substr(0, 3), "end")) {
      return take_end(word.substr(3));
    } else if (file::is_word(word, "solid")) {
      is_ended_ = false;
      facets_of_solid_ = 0;
      pass_name();
    } else {
      return file::is_word(word, "normal") || file::is_word(word, "outer") ||
             file::is_word(word, "loop");
    }
    return true;
  }

  bool take_end(std::string_view what) {
    if (file::is_word(what, "facet")) {
      end_facet();
    } else if (file::is_word(what, "solid")) {
      is_ended_ = true;
      facets_of_solid_ = 0;
      ++solids_;
      pass_name();
    } else {
      return file::is_word(what, "loop");
    }
    return true;
  }

  bool is_of_normal(std::string_view word) const {
    return is_open_ && corners_ == 0 && file::to_number(word);
  }

  void begin_facet() {
    if (is_open_) lines_.refuse_here("a facet begins within a facet");
    is_open_ = true;
    is_ended_ = false;
    corners_ = 0;
  }

  void add_vertex() {
    if (!is_open_) lines_.refuse_here("a vertex outside of a facet");
    if (mesh_.vertices.size() >= kMaxVertices) lines_.refuse_here("more than 2^32 - 2 vertices");
    add_corner(mesh_, lines_.point());
    ++corners_;
  }

  void end_facet() {
    if (!is_open_ || corners_ != 3) lines_.refuse_here("a facet must have 3 vertices");
    is_open_ = false;
    ++facets_of_solid_;
    mesh_.end_polygon();
  }

  // Passes over a solid's name, which may hold any words: up to the line's end, or to a facet with
  // its normal in the same line.
  void pass_name() {
    lines_.cross_lines(false);
    file::TextLines ahead = lines_;
    for (std::string_view word = ahead.word(); !word.empty(); word = ahead.word()) {
      if (file::is_word(word, "facet") && is_facet(ahead)) break;
      lines_ = ahead;
    }
    lines_.cross_lines(true);
  }

  // True if "normal" and a number follow, or "outer loop".
  static bool is_facet(file::TextLines lines) {
    const std::string_view first = lines.word(), second = lines.word();
    return (file::is_word(first, "normal") && file::to_number(second)) ||
           (file::is_word(first, "outer") && file::is_word(second, "loop"));
  }

  void finish() {
    if (is_open_ || (!is_ended_ && facets_of_solid_ == 0))
      refuse("the file ends without 'endsolid'; it is truncated", mesh_.name);
    if (!is_ended_) {
      ++solids_;
      mesh_.doubt = "the file ends without 'endsolid', after " +
                    counted(facets_of_solid_, "whole facet") + "; it may be truncated";
      mesh_.notes.push_back(mesh_.doubt);
    }
    if (solids_ > 1)
      mesh_.notes.push_back(counted(solids_, "solid") +
                            " stand one after the other; all were read");
  }

  file::TextLines lines_;
  RawMesh& mesh_;
  std::size_t corners_ = 0;  // number read of the facet
  std::size_t facets_of_solid_ = 0, solids_ = 0;
  bool is_open_ = false, is_ended_ = false;
};

void parse_binary(std::string_view bytes, RawMesh& mesh) {
  Facets facets = find_facets(bytes, mesh.name);
  const std::size_t count = facets.at.size();
  if (3 * count > kMaxVertices) refuse("more than 2^32 - 2 corners", mesh.name);
  mesh.vertices.reserve(3 * count);
  mesh.corners.reserve(3 * count);
  mesh.polygon_end.reserve(count);
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t at = facets.at[k];
    Vec3f corner[3];
    std::memcpy(corner, bytes.data() + at + kCornersAt, sizeof corner);
    for (const Vec3f& p : corner) {
      if (!is_finite(p)) {
        refuse("triangle " + std::to_string(k) + " (at byte " + std::to_string(at) +
                   "): a coordinate is not finite",
               mesh.name);
      }
      add_corner(mesh, widen(p));
    }
    mesh.end_polygon();
  }
  if (!facets.note.empty()) mesh.notes.push_back(std::move(facets.note));
  mesh.doubt = std::move(facets.doubt);
}

}  // namespace

bool looks_like_stl(std::string_view bytes) {
  if (has_binary_size(bytes) || joined_files(bytes)) return true;
  return looks_like_ascii(bytes) &&
         file::in_lower_case(bytes.substr(0, 65536)).find("facet") != std::string::npos;
}

RawMesh parse_stl(std::string_view bytes, const std::string& name) {
  RawMesh mesh;
  mesh.format = MeshFormat::stl;
  mesh.name = name;
  // The size decides first, since exporters of binary files write "solid" into the header too.
  if (!has_binary_size(bytes) && looks_like_ascii(bytes)) {
    Text(bytes, mesh).parse();
  } else if (bytes.size() < kFacetsAt) {
    refuse(
        std::to_string(bytes.size()) + " bytes are too few for a binary STL file; it is truncated",
        name);
  } else if (begins_as_text(bytes)) {
    refuse("the file is text, but no STL, which would begin with 'solid'", name);
  } else {
    parse_binary(bytes, mesh);
  }
  return mesh;
}

}  // namespace vpm
