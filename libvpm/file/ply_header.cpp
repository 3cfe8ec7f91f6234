#include "libvpm/file/ply_header.h"

#include <utility>

#include "libvpm/core/error.h"
#include "libvpm/file/text.h"
#include "libvpm/file/text_lines.h"

namespace vpm::file {
namespace {

ScalarType parse_type(const TextLines& lines, std::string_view word) {
  static constexpr std::pair<std::string_view, ScalarType> kTypes[] = {
      {"char", {'I', 1}},  {"int8", {'I', 1}},    {"uchar", {'U', 1}},  {"uint8", {'U', 1}},
      {"short", {'I', 2}}, {"int16", {'I', 2}},   {"ushort", {'U', 2}}, {"uint16", {'U', 2}},
      {"int", {'I', 4}},   {"int32", {'I', 4}},   {"uint", {'U', 4}},   {"uint32", {'U', 4}},
      {"float", {'F', 4}}, {"float32", {'F', 4}}, {"double", {'F', 8}}, {"float64", {'F', 8}}};
  for (const auto& [text, type] : kTypes)
    if (is_word(word, text)) return type;
  lines.refuse_here(shown(word, kLongestShown) + " is not a type of a PLY property");
}

PlyProperty parse_property(TextLines& lines) {
  PlyProperty property;
  std::string_view word = lines.word();
  if (is_word(word, "list")) {
    property.length_type = parse_type(lines, lines.word());
    if (property.length_type.kind == 'F')
      lines.refuse_here("the length of a list must be an integer");
    word = lines.word();
  }
  property.type = parse_type(lines, word);
  property.name = lines.word();
  if (property.name.empty()) lines.refuse_here("the property has no name");
  return property;
}

PlyElement parse_element(TextLines& lines) {
  PlyElement element;
  element.name = lines.word();
  const std::int64_t count = lines.integer("the element's count");
  if (count < 0) lines.refuse_here("the element's count is negative");
  element.count = static_cast<std::uint64_t>(count);
  return element;
}

PlyEncoding parse_encoding(TextLines& lines) {
  const std::string_view word = lines.word();
  if (is_word(word, "ascii")) return PlyEncoding::text;
  if (is_word(word, "binary_little_endian")) return PlyEncoding::little_endian;
  if (is_word(word, "binary_big_endian")) return PlyEncoding::big_endian;
  lines.refuse_here("unknown format; it must be ascii, binary_little_endian or binary_big_endian");
}

// Checks counts. A list takes at least its length, a text value at least a digit and a separator.
void check_counts(const PlyHeader& header, std::size_t file_bytes, const std::string& name) {
  double least = static_cast<double>(header.body) - 1;
  std::vector<std::string> what;
  for (const PlyElement& element : header.elements) {
    double each = 0;
    for (const PlyProperty& p : element.properties)
      each += header.encoding == PlyEncoding::text ? 2
              : p.is_list()                        ? p.length_type.size
                                                   : p.type.size;
    // An element without properties would take no bytes, so its count could be anything.
    if (element.properties.empty() && element.count > 0)
      refuse("the element '" + shown(element.name, kLongestShown) + "' has no properties", name);
    least += each * static_cast<double>(element.count);
    what.push_back(std::to_string(element.count) + " x " + element.name);
  }
  check_header_counts(name, listed(what), least, file_bytes);
}

}  // namespace

bool looks_like_ply(std::string_view bytes) {
  constexpr std::string_view kFirst = "ply", kAfter = " \t\r\n";
  return bytes.size() > kFirst.size() && is_word(bytes.substr(0, kFirst.size()), kFirst) &&
         kAfter.find(bytes[kFirst.size()]) != kAfter.npos;
}

PlyHeader parse_ply_header(std::string_view bytes, const std::string& name) {
  if (!looks_like_ply(bytes)) refuse("line 1: a PLY file must begin with 'ply'", name);
  PlyHeader header;
  TextLines lines(bytes, name, 0);
  bool has_format = false;
  lines.require_line("'ply'");
  for (;;) {
    lines.require_line("'end_header'");
    const std::string_view keyword = lines.word();
    if (is_word(keyword, "format")) {
      header.encoding = parse_encoding(lines);
      has_format = true;
    } else if (is_word(keyword, "element")) {
      header.elements.push_back(parse_element(lines));
    } else if (is_word(keyword, "property")) {
      if (header.elements.empty()) lines.refuse_here("a property before the first element");
      header.elements.back().properties.push_back(parse_property(lines));
    } else if (is_word(keyword, "end_header")) {
      break;
    } else if (is_word(keyword, "comment")) {
      if (lines.word() == "vpm" && lines.word() == "origin") header.origin = lines.point();
    } else if (!is_word(keyword, "obj_info")) {
      lines.refuse_here("not a statement of a PLY header");
    }
  }
  if (!has_format) refuse("the header has no 'format' line", name);
  header.body = lines.offset();
  header.lines = lines.line_number();
  check_counts(header, bytes.size(), name);
  return header;
}

const PlyElement* find_element(const PlyHeader& header, std::string_view element,
                               const std::string& name) {
  const PlyElement* found = nullptr;
  for (const PlyElement& other : header.elements) {
    if (!is_word(other.name, element)) continue;
    if (found != nullptr)
      refuse("the header has two elements '" + std::string(element) + "'", name);
    found = &other;
  }
  return found;
}

}  // namespace vpm::file
