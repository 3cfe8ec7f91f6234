// Object File Format, as text and as binary. Text is a keyword, three counts, then vertices and
// faces.
//
// Geomview, whose format it is, reads words wherever lines end; most programs write one vertex or
// face per line, and many append colours or normals that the keyword does not announce. So a file
// is read by lines where each line holds at least what it must, and by words otherwise.
#include <algorithm>
#include <bit>
#include <cstring>
#include <optional>

#include "libvpm/core/error.h"
#include "libvpm/file/text_lines.h"
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

// Reads Object File Format as binary, from what follows the first line. Files state neither byte
// order nor colours of faces: Geomview writes big-endian with a count of colour components after
// each face, OpenMesh little-endian without. The variant that uses up the file is taken.
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

// Parts that a keyword announces, in the order of its letters: [ST][C][N][4][n]OFF.
struct Keyword {
  bool has_texture = false, has_color = false, has_normal = false, has_w = false,
       states_dimension = false;
};

constexpr std::string_view kOff = "OFF";

std::optional<Keyword> parse_keyword(std::string_view prefix) {
  const auto take = [&](std::string_view letters) {
    const bool has = prefix.starts_with(letters);
    if (has) prefix.remove_prefix(letters.size());
    return has;
  };
  Keyword keyword;
  keyword.has_texture = take("ST");
  keyword.has_color = take("C");
  keyword.has_normal = take("N");
  keyword.has_w = take("4");
  keyword.states_dimension = take("n");
  return prefix.empty() ? std::optional(keyword) : std::nullopt;
}

// Returns the length of the keyword, such as "COFF", with which the text begins; 0 if there is
// none. Counts may follow without a blank: "OFF8 12 0".
std::size_t keyword_length(std::string_view text) {
  constexpr std::size_t kLongestPrefix = 6;  // STCN4n
  std::size_t at = text.substr(0, kLongestPrefix + kOff.size()).find(kOff);
  if (file::is_word(text.substr(0, kOff.size()), "off")) at = 0;
  if (at == text.npos || !parse_keyword(text.substr(0, at))) return 0;
  const std::size_t length = at + kOff.size();
  const char next = length < text.size() ? text[length] : ' ';
  return next == ' ' || next == '\t' || (next >= '0' && next <= '9') ? length : 0;
}

struct Header {
  Keyword keyword;
  std::int64_t vertices = 0, faces = 0;
};

// Takes the third count, of edges, which some files leave out. It may stand on a line of its own.
void pass_edge_count(file::TextLines& lines) {
  lines.cross_lines(false);
  file::TextLines ahead = lines;
  const bool is_on_line = !lines.rest().empty();
  if (!is_on_line && !ahead.next_line()) return;
  const std::string_view count = ahead.word();
  if (file::to_count(count) && (is_on_line || ahead.rest().empty())) lines = ahead;
}

Header parse_header(file::TextLines& lines, const Keyword& keyword) {
  Header header{.keyword = keyword};
  lines.cross_lines(true);
  if (keyword.states_dimension) {
    const std::int64_t dimension = lines.integer("the dimension");
    if (dimension != 3)
      lines.refuse_here("its points have " + std::to_string(dimension) + " dimensions, not 3");
  }
  header.vertices = lines.integer("the number of vertices");
  header.faces = lines.integer("the number of faces");
  if (header.vertices < 0 || header.faces < 0) lines.refuse_here("a count is negative");
  pass_edge_count(lines);
  return header;
}

// Returns the number of words left in the line, or many if they are more than of any vertex.
std::size_t words_left(file::TextLines lines) {
  constexpr std::size_t kMany = 100;
  std::size_t count = 0;
  while (count < kMany && !lines.word().empty()) ++count;
  return count;
}

// True if the rest of the line begins with a face of three corners or more.
bool holds_face(file::TextLines lines) {
  lines.cross_lines(false);
  const auto corners = file::to_count(lines.word());
  return corners && *corners >= 3 && words_left(lines) >= *corners;
}

// Reads the vertices and faces that the header announces.
class Body {
 public:
  Body(const Header& header, const RawMesh& empty) : header_(header), mesh_(empty) {
    mesh_.vertices.reserve(static_cast<std::size_t>(header.vertices));
    mesh_.polygon_end.reserve(static_cast<std::size_t>(header.faces));
  }

  // Takes each vertex and face from a line of its own, and passes over what else is in it. Says
  // whether lines are left.
  RawMesh by_lines(file::TextLines lines, bool& has_more) {
    lines.cross_lines(false);
    std::size_t extras_of_first = 0;
    for (std::int64_t k = 0; k < header_.vertices; ++k) {
      lines.require_line("a vertex");
      add_vertex(lines);
      if (k != 0 && k + 1 != header_.vertices) continue;
      const std::size_t extras = words_left(lines);
      if (k == 0) extras_of_first = extras;
      if (extras != extras_of_first) suspect_vertex(lines);
    }
    for (std::int64_t k = 0; k < header_.faces; ++k) {
      lines.require_line("a face");
      add_face(lines);
    }
    has_more = lines.next_line();
    if (has_more) say_unread(lines);
    return finished();
  }

  // Takes words wherever lines end, with `extras` numbers after each vertex. Colours after a face,
  // if there are any, end with its line. Empty if words are left.
  std::optional<RawMesh> by_words(file::TextLines lines, int extras, bool faces_have_colors) {
    lines.cross_lines(true);
    std::int64_t cut_lines = 0;  // those that go on after a vertex
    for (std::int64_t k = 0; k < header_.vertices; ++k) {
      add_vertex(lines);
      for (int extra = 0; extra < extras; ++extra) lines.number("a vertex's colour or normal");
      const bool cuts_line = !lines.rest().empty(), is_last = k > 0 && k + 1 == header_.vertices;
      if (is_last && cuts_line && cut_lines == 0 && !holds_face(lines)) suspect_vertex(lines);
      cut_lines += cuts_line;
    }
    for (std::int64_t k = 0; k < header_.faces; ++k) {
      add_face(lines);
      if (faces_have_colors) lines.pass(lines.rest().size());
    }
    if (!lines.word().empty()) return std::nullopt;
    return finished();
  }

 private:
  void add_vertex(file::TextLines& lines) {
    Vec3 p = lines.point();
    if (header_.keyword.has_w) {
      const double w = lines.number("w");
      if (w == 0 || !is_finite(p / w))
        lines.refuse_here("the vertex divided by its w is not finite");
      divided_ += w != 1;
      p = p / w;
    }
    mesh_.vertices.push_back(p);
  }

  void add_face(file::TextLines& lines) {
    const std::int64_t corners = lines.integer("the face's number of corners");
    if (corners < 0) lines.refuse_here("the face's number of corners is negative");
    for (std::int64_t c = 0; c < corners; ++c) {
      const std::int64_t index = lines.integer("a vertex index");
      if (index < 0 || index >= header_.vertices) {
        lines.refuse_here("vertex index " + std::to_string(index) +
                          " is out of range; the header says " + std::to_string(header_.vertices) +
                          " vertices, counted from 0");
      }
      mesh_.corners.push_back(static_cast<std::uint32_t>(index));
    }
    mesh_.end_polygon();
  }

  // Says that the last vertex differs from those before it: the header may count a face as one.
  void suspect_vertex(const file::TextLines& lines) {
    say("the header counts " + std::to_string(header_.vertices) + " vertices, but line " +
        std::to_string(lines.line_number()) + " does not look like one");
  }

  void say_unread(const file::TextLines& lines) {
    const std::string in_line = " in line " + std::to_string(lines.line_number());
    if (keyword_length(lines.rest()) > 0) {
      say("another OFF file follows" + in_line + ", which is not read");
    } else {
      say("the header counts " + std::to_string(header_.faces) +
          (header_.faces == 1 ? " face" : " faces") + ", but more follows" + in_line +
          ", which is not read");
    }
  }

  void say(const std::string& defect) {
    mesh_.notes.push_back(defect);
    if (mesh_.doubt.empty()) mesh_.doubt = defect;
  }

  RawMesh finished() {
    note_division(divided_, mesh_);
    return std::move(mesh_);
  }

  const Header& header_;
  RawMesh mesh_;
  std::size_t divided_ = 0;
};

// Reads by words in the ways that the keyword allows; empty if none uses up the file. Colours have
// four numbers by the format, and three in many files.
std::optional<RawMesh> read_by_words(const file::TextLines& lines, const Header& header,
                                     const RawMesh& empty) {
  const Keyword& keyword = header.keyword;
  const int others = (keyword.has_texture ? 2 : 0) + (keyword.has_normal ? 3 : 0);
  for (const int color : {4, 3}) {
    for (const bool faces_have_colors : {false, true}) {
      try {
        const int extras = others + (keyword.has_color ? color : 0);
        auto mesh = Body(header, empty).by_words(lines, extras, faces_have_colors);
        if (mesh) return mesh;
      } catch (const Error&) {  // the next way may fit
      }
    }
    if (!keyword.has_color) break;
  }
  return std::nullopt;
}

}  // namespace

bool looks_like_off(std::string_view text) {
  file::TextLines lines(text.substr(0, 65536), "", '#');
  return lines.next_line() && keyword_length(lines.rest()) > 0;
}

RawMesh parse_off(std::string_view text, const std::string& name) {
  RawMesh empty;
  empty.format = MeshFormat::off;
  empty.name = name;
  file::TextLines lines(file::without_padding(text), name, '#');
  lines.require_line("the keyword OFF");
  const std::size_t length = keyword_length(lines.rest());
  // Geomview reads files that begin with the counts, too.
  if (length == 0 && !file::to_count(lines.rest().substr(0, lines.rest().find_first_of(" \t"))))
    lines.refuse_here("expected the keyword OFF, or COFF, NOFF, STOFF, 4OFF");
  const std::string_view before = lines.rest().substr(0, length == 0 ? 0 : length - kOff.size());
  const Keyword keyword = *parse_keyword(before);
  lines.pass(length);
  if (file::is_word(lines.rest().substr(0, 6), "binary")) {
    if (!before.empty())
      lines.refuse_here("binary OFF is read with three coordinates only; save it as text");
    return parse_off_binary(text.substr(lines.offset()), name);
  }
  const Header header = parse_header(lines, keyword);
  // A vertex takes at least "0 0 0\n", a face "0\n".
  file::check_header_counts(
      name,
      std::to_string(header.vertices) + " vertices and " + std::to_string(header.faces) + " faces",
      6.0 * static_cast<double>(header.vertices) + 2.0 * static_cast<double>(header.faces) - 1,
      text.size());
  try {
    bool has_more = false;
    RawMesh mesh = Body(header, empty).by_lines(lines, has_more);
    if (!has_more) return mesh;
    return read_by_words(lines, header, empty).value_or(std::move(mesh));
  } catch (const Error&) {
    if (std::optional<RawMesh> mesh = read_by_words(lines, header, empty)) return *std::move(mesh);
    throw;
  }
}

}  // namespace vpm
