// Polygon File Format (Stanford): a header describing elements and their properties, then the
// elements, as text or as binary of either byte order.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

#include "libvpm/core/error.h"
#include "libvpm/mesh/mesh_parsers.h"
#include "libvpm/mesh/text_lines.h"

namespace vpm {
namespace {

enum class Type { int8, uint8, int16, uint16, int32, uint32, float32, float64 };
enum class Encoding { ascii, little, big };

struct Property {
  Type type = Type::float32;
  bool is_list = false;
  Type count_type = Type::uint8;
  std::string name;
};

struct Element {
  std::string name;
  std::size_t count = 0;
  std::vector<Property> properties;
};

struct Header {
  Encoding encoding = Encoding::ascii;
  std::vector<Element> elements;
  std::size_t body = 0;  // offset of the first byte after the header
  std::size_t lines = 0;
};

struct TypeName {
  const char* name;
  Type type;
};
constexpr std::array<TypeName, 16> kTypeNames{{{"char", Type::int8},
                                               {"uchar", Type::uint8},
                                               {"short", Type::int16},
                                               {"ushort", Type::uint16},
                                               {"int", Type::int32},
                                               {"uint", Type::uint32},
                                               {"float", Type::float32},
                                               {"double", Type::float64},
                                               {"int8", Type::int8},
                                               {"uint8", Type::uint8},
                                               {"int16", Type::int16},
                                               {"uint16", Type::uint16},
                                               {"int32", Type::int32},
                                               {"uint32", Type::uint32},
                                               {"float32", Type::float32},
                                               {"float64", Type::float64}}};

std::size_t size_of(Type type) {
  constexpr std::array<std::size_t, 8> kSizes{1, 1, 2, 2, 4, 4, 4, 8};
  return kSizes[static_cast<std::size_t>(type)];
}

Type parse_type(const TextLines& lines, std::string_view word) {
  for (const TypeName& known : kTypeNames) {
    if (word == known.name) return known.type;
  }
  lines.refuse_here(file::shown(word, 40) + " is not a type of a PLY property");
}

Property parse_property(TextLines& lines) {
  Property property;
  std::string_view word = lines.word();
  property.is_list = word == "list";
  if (property.is_list) {
    property.count_type = parse_type(lines, lines.word());
    if (property.count_type == Type::float32 || property.count_type == Type::float64)
      lines.refuse_here("the length of a list must be an integer");
    word = lines.word();
  }
  property.type = parse_type(lines, word);
  property.name = lines.word();
  if (property.name.empty()) lines.refuse_here("the property has no name");
  return property;
}

Encoding parse_encoding(TextLines& lines) {
  const std::string_view word = lines.word();
  if (word == "ascii") return Encoding::ascii;
  if (word == "binary_little_endian") return Encoding::little;
  if (word == "binary_big_endian") return Encoding::big;
  lines.refuse_here("unknown format; it must be ascii, binary_little_endian or binary_big_endian");
}

Header parse_header(std::string_view bytes, const std::string& name) {
  Header header;
  TextLines lines(bytes, name, 0);
  bool has_format = false;
  lines.require_line("'ply'");
  for (;;) {
    lines.require_line("'end_header'");
    const std::string_view keyword = lines.word();
    if (keyword == "format") {
      header.encoding = parse_encoding(lines);
      has_format = true;
    } else if (keyword == "element") {
      Element element;
      element.name = lines.word();
      const std::int64_t count = lines.integer("the element's count");
      if (count < 0) lines.refuse_here("the element's count is negative");
      element.count = static_cast<std::size_t>(count);
      header.elements.push_back(std::move(element));
    } else if (keyword == "property") {
      if (header.elements.empty()) lines.refuse_here("a property before the first element");
      header.elements.back().properties.push_back(parse_property(lines));
    } else if (keyword == "end_header") {
      break;
    } else if (keyword != "comment" && keyword != "obj_info") {
      lines.refuse_here("not a statement of a PLY header");
    }
  }
  if (!has_format) refuse("the header has no 'format' line", name);
  header.body = lines.offset();
  header.lines = lines.line_number();
  return header;
}

// Checks counts. A list takes at least its length, a text value at least a digit and a separator.
void check_counts(const Header& header, std::size_t file_bytes, const std::string& name) {
  double least = static_cast<double>(header.body) - 1;
  std::string what;
  for (const Element& element : header.elements) {
    double each = 0;
    for (const Property& p : element.properties) {
      if (header.encoding == Encoding::ascii) {
        each += 2;
      } else {
        each += static_cast<double>(size_of(p.is_list ? p.count_type : p.type));
      }
    }
    // An element without properties would take no bytes, so its count could be anything.
    if (element.properties.empty() && element.count > 0)
      refuse("the element '" + element.name + "' has no properties", name);
    least += each * static_cast<double>(element.count);
    what += (what.empty() ? "" : ", ") + std::to_string(element.count) + " x " + element.name;
  }
  check_header_counts(name, what, least, file_bytes);
}

class TextBody {
 public:
  TextBody(std::string_view bytes, const Header& header, const std::string& name)
      : lines_(bytes, name, 0) {
    for (std::size_t k = 0; k < header.lines;) {
      lines_.next_line();
      k = lines_.line_number();
    }
  }
  void begin_record() { lines_.require_line("another element"); }
  void end_record() {
    if (lines_.rest().empty()) return;
    if (longer_ == 0) first_longer_ = lines_.line_number();
    ++longer_;
  }
  double value(Type) { return lines_.number("a value"); }
  [[noreturn]] void refuse_here(const std::string& defect) const { lines_.refuse_here(defect); }
  // True if `count` more values may follow; lines are bounded by the file's size.
  bool holds(std::size_t, Type) const { return true; }

  // Says what the records' lines hold beyond their values; empty if nothing.
  std::string excess() const {
    if (longer_ == 0) return {};
    const std::string line = "line " + std::to_string(first_longer_);
    return (longer_ == 1
                ? line + " holds"
                : std::to_string(longer_) + " lines, the first of them " + line + ", hold") +
           " more numbers than the header says; they are not read";
  }
  // Returns what follows the last record, and moves there; empty if nothing does.
  std::string_view rest() { return lines_.next_line() ? lines_.rest() : std::string_view(); }
  std::string more_follows() const { return "more follows " + place() + ", which is not read"; }
  std::string place() const { return "in line " + std::to_string(lines_.line_number()); }

 private:
  TextLines lines_;
  std::size_t longer_ = 0, first_longer_ = 0;  // lines with more than a record
};

class BinaryBody {
 public:
  BinaryBody(std::string_view bytes, const Header& header, const std::string& name)
      : bytes_(bytes), name_(name), at_(header.body), swap_(header.encoding == Encoding::big) {}
  void begin_record() {}
  void end_record() {}
  double value(Type type) {
    std::array<char, 8> raw{};
    const std::size_t size = size_of(type);
    if (bytes_.size() - at_ < size) {
      refuse("the file ends at byte " + std::to_string(bytes_.size()) +
                 " within an element; it is truncated",
             name_);
    }
    std::memcpy(raw.data(), bytes_.data() + at_, size);
    at_ += size;
    if (swap_) std::reverse(raw.begin(), raw.begin() + static_cast<std::ptrdiff_t>(size));
    switch (type) {
      case Type::int8:
        return as<std::int8_t>(raw);
      case Type::uint8:
        return as<std::uint8_t>(raw);
      case Type::int16:
        return as<std::int16_t>(raw);
      case Type::uint16:
        return as<std::uint16_t>(raw);
      case Type::int32:
        return as<std::int32_t>(raw);
      case Type::uint32:
        return as<std::uint32_t>(raw);
      case Type::float32:
        return static_cast<double>(as<float>(raw));
      case Type::float64:
        return as<double>(raw);
    }
    return 0;
  }
  [[noreturn]] void refuse_here(const std::string& defect) const {
    refuse(defect, name_ + ": at byte " + std::to_string(at_));
  }
  bool holds(std::size_t count, Type type) const {
    return count <= (bytes_.size() - at_) / size_of(type);
  }
  std::string excess() const { return {}; }
  // Returns what follows the last record; empty if that is at most an end of a line or padding.
  std::string_view rest() const {
    const std::string_view rest = bytes_.substr(at_);
    return rest.find_first_not_of(kEnd) == rest.npos ? std::string_view() : rest;
  }
  std::string more_follows() const {
    return std::to_string(bytes_.size() - at_) + " bytes more follow " + place() +
           ", which are not read";
  }
  std::string place() const { return "at byte " + std::to_string(at_); }

 private:
  template <class T>
  static T as(const std::array<char, 8>& raw) {
    T value;
    std::memcpy(&value, raw.data(), sizeof value);
    return value;
  }
  static constexpr std::string_view kEnd{"\0\x1a\r\n", 4};

  std::string_view bytes_;
  const std::string& name_;
  std::size_t at_;
  bool swap_;
};

static_assert(std::endian::native == std::endian::little, "BinaryBody swaps only big-endian files");

template <class Body>
std::size_t list_length(Body& body, const Property& property) {
  const double length = body.value(property.count_type);
  if (!(length >= 0) || length != std::floor(length) || length > 4294967295.0)
    body.refuse_here("the length of a list is not a whole number");
  const auto count = static_cast<std::size_t>(length);
  if (!body.holds(count, property.type)) {
    body.refuse_here("a list of " + std::to_string(count) +
                     " values is longer than the rest of the file");
  }
  return count;
}

template <class Body>
void skip(Body& body, const Property& property) {
  const std::size_t count = property.is_list ? list_length(body, property) : 1;
  for (std::size_t k = 0; k < count; ++k) body.value(property.type);
}

template <class Body>
void read_vertex(Body& body, const Element& element, RawMesh& mesh) {
  Vec3 p;
  for (const Property& property : element.properties) {
    double* const coordinate = property.is_list       ? nullptr
                               : property.name == "x" ? &p.x
                               : property.name == "y" ? &p.y
                               : property.name == "z" ? &p.z
                                                      : nullptr;
    if (coordinate == nullptr) {
      skip(body, property);
    } else {
      *coordinate = body.value(property.type);
    }
  }
  if (!is_finite(p)) {
    body.refuse_here("vertex " + std::to_string(mesh.vertices.size()) +
                     ": a coordinate is not finite");
  }
  mesh.vertices.push_back(p);
}

bool is_corner_list(const Property& property) {
  return property.is_list && (property.name == "vertex_indices" || property.name == "vertex_index");
}

template <class Body>
void read_face(Body& body, const Element& element, std::size_t vertex_count, RawMesh& mesh) {
  const std::string face = "face " + std::to_string(mesh.polygon_end.size());
  for (const Property& property : element.properties) {
    if (!is_corner_list(property)) {
      skip(body, property);
      continue;
    }
    const std::size_t count = list_length(body, property);
    for (std::size_t k = 0; k < count; ++k) {
      const double index = body.value(property.type);
      if (!(index >= 0 && index < static_cast<double>(vertex_count) &&
            index == std::floor(index))) {
        body.refuse_here(face + ": a vertex index is out of range; the header says " +
                         std::to_string(vertex_count) + " vertices, counted from 0");
      }
      mesh.corners.push_back(static_cast<std::uint32_t>(index));
    }
    mesh.end_polygon();
  }
}

std::size_t count_of(const Header& header, std::string_view name) {
  for (const Element& element : header.elements) {
    if (element.name == name) return element.count;
  }
  return 0;
}

std::string last_count(const Header& header) {
  const Element& last = header.elements.back();
  if (last.name != "face") return std::to_string(last.count) + " x " + file::shown(last.name, 40);
  return std::to_string(last.count) + (last.count == 1 ? " face" : " faces");
}

// Says what the header does not count, and so was not read.
template <class Body>
void say_unread(Body& body, const Header& header, RawMesh& mesh) {
  const std::string excess = body.excess();
  const std::string_view rest = body.rest();
  if (!excess.empty()) mesh.notes.push_back(excess);
  if (looks_like_ply(rest) || rest == "ply") {
    mesh.notes.push_back("another PLY file follows " + body.place() + ", which is not read");
  } else if (!rest.empty()) {
    mesh.notes.push_back("the header counts " + last_count(header) + ", but " +
                         body.more_follows());
  }
  if (!mesh.notes.empty()) mesh.doubt = mesh.notes.front();
}

template <class Body>
void read_body(Body body, const Header& header, RawMesh& mesh) {
  const std::size_t vertices = count_of(header, "vertex");
  mesh.vertices.reserve(vertices);
  mesh.polygon_end.reserve(count_of(header, "face"));
  for (const Element& element : header.elements) {
    for (std::size_t k = 0; k < element.count; ++k) {
      body.begin_record();
      if (element.name == "vertex") {
        read_vertex(body, element, mesh);
      } else if (element.name == "face") {
        read_face(body, element, vertices, mesh);
      } else {
        for (const Property& property : element.properties) skip(body, property);
      }
      body.end_record();
    }
  }
  say_unread(body, header, mesh);
}

void check_elements(const Header& header, const std::string& name) {
  std::size_t vertex_elements = 0, face_elements = 0;
  for (const Element& element : header.elements) {
    if (element.name == "vertex") {
      ++vertex_elements;
      for (const char* const axis : {"x", "y", "z"}) {
        const auto is_axis = [&](const Property& p) { return p.name == axis && !p.is_list; };
        if (std::count_if(element.properties.begin(), element.properties.end(), is_axis) != 1)
          refuse(std::string("the header must give the vertices one property '") + axis + "'",
                 name);
      }
      if (element.count > kMaxVertices) refuse("more than 2^32 - 2 vertices", name);
    }
    if (element.name == "face") {
      ++face_elements;
      if (std::count_if(element.properties.begin(), element.properties.end(), is_corner_list) != 1)
        refuse("the header must give the faces one list 'vertex_indices'", name);
    }
  }
  if (vertex_elements != 1 || face_elements != 1) {
    refuse(std::string("the header must have one element 'vertex' and one element 'face'") +
               (face_elements == 0 ? "; this is a cloud of points or strips, not a mesh of faces"
                                   : ""),
           name);
  }
}

}  // namespace

bool looks_like_ply(std::string_view bytes) {
  return bytes.starts_with("ply\n") || bytes.starts_with("ply\r") || bytes.starts_with("ply ");
}

RawMesh parse_ply(std::string_view bytes, const std::string& name) {
  if (!looks_like_ply(bytes)) refuse("line 1: a PLY file must begin with 'ply'", name);
  RawMesh mesh;
  mesh.format = MeshFormat::ply;
  mesh.name = name;
  const Header header = parse_header(bytes, name);
  check_counts(header, bytes.size(), name);
  check_elements(header, name);
  if (header.encoding == Encoding::ascii) {
    read_body(TextBody(without_padding(bytes), header, name), header, mesh);
  } else {
    read_body(BinaryBody(bytes, header, name), header, mesh);
  }
  return mesh;
}

}  // namespace vpm
