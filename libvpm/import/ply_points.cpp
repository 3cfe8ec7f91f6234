#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "libvpm/core/error.h"
#include "libvpm/file/text.h"
#include "libvpm/import/point_files.h"
#include "libvpm/import/scalar_type.h"

namespace vpm {
namespace {

struct Property {
  std::string name;
  ScalarType type;
  ScalarType count_type;  // type of a list's length; size 0: a single value
  int column = -1;        // index into x y z nx ny nz
};

struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};

constexpr std::array<const char*, 6> kColumns{"x", "y", "z", "nx", "ny", "nz"};

ScalarType scalar_type(std::string_view name) {
  static constexpr std::pair<std::string_view, ScalarType> kTypes[] = {
      {"char", {'I', 1}},  {"int8", {'I', 1}},    {"uchar", {'U', 1}},  {"uint8", {'U', 1}},
      {"short", {'I', 2}}, {"int16", {'I', 2}},   {"ushort", {'U', 2}}, {"uint16", {'U', 2}},
      {"int", {'I', 4}},   {"int32", {'I', 4}},   {"uint", {'U', 4}},   {"uint32", {'U', 4}},
      {"float", {'F', 4}}, {"float32", {'F', 4}}, {"double", {'F', 8}}, {"float64", {'F', 8}}};
  for (const auto& [text, type] : kTypes) {
    if (text == name) return type;
  }
  return {};
}

// Returns e.g. "vertex 12", for messages.
std::string where(const Element& element, std::uint64_t row) {
  return file::shown(element.name) + " " + std::to_string(row);
}

class PlyParser {
 public:
  PlyParser(std::span<const std::byte> bytes, const std::string& name)
      : bytes_(bytes), name_(name), cursor_(file::as_text(bytes)) {}

  PointSet parse() {
    read_header();
    const Element& vertices = vertex_element();
    at_ = cursor_.offset();
    for (const Element& element : elements_) {
      check_count(element);
      if (&element == &vertices) {
        points_.width = static_cast<std::uint32_t>(element.count);
        points_.positions.resize(element.count);
        if (has_normals_) points_.normals.resize(element.count);
      }
      for (std::uint64_t row = 0; row < element.count; ++row)
        read_row(element, row, &element == &vertices);
    }
    if (ascii_ && !cursor_.row().empty()) fail("has more rows than its header says");
    return std::move(points_);
  }

 private:
  [[noreturn]] void fail(const std::string& defect) const { refuse("PLY " + defect, name_); }

  void read_header();
  void read_property(const std::vector<std::string_view>& words);
  const Element& vertex_element();
  void check_count(const Element& element) const;
  void read_row(const Element& element, std::uint64_t row, bool keep);
  double read_value(ScalarType type, const Element& element, std::uint64_t row);
  void store(int column, std::uint64_t row, double value);

  std::span<const std::byte> bytes_;
  const std::string& name_;
  file::TextCursor cursor_;
  std::size_t at_ = 0;
  std::vector<std::string_view> row_;  // words of a line of text
  std::size_t word_ = 0;               // index of the next
  bool ascii_ = false, big_endian_ = false, has_normals_ = false;
  std::vector<Element> elements_;
  PointSet points_;
};

void PlyParser::read_header() {
  bool has_format = false;
  cursor_.line();  // skips the magic
  for (;;) {
    const std::optional<std::string_view> line = cursor_.line();
    if (!line) fail("header ends before end_header");
    const std::vector<std::string_view> words = file::split_words(*line);
    if (words.empty() || words[0] == "comment" || words[0] == "obj_info") continue;
    if (words[0] == "end_header") break;
    if (words[0] == "format" && words.size() == 3) {
      ascii_ = words[1] == "ascii";
      big_endian_ = words[1] == "binary_big_endian";
      has_format = ascii_ || big_endian_ || words[1] == "binary_little_endian";
    } else if (words[0] == "element" && words.size() == 3) {
      const std::optional<std::uint64_t> count = file::to_count(words[2]);
      if (!count) fail("header: '" + file::shown(words[2]) + "' is not a count");
      elements_.push_back({std::string(words[1]), *count, {}});
    } else if (words[0] == "property") {
      read_property(words);
    } else {
      fail("header: cannot read '" + file::shown(*line) + "'");
    }
  }
  if (!has_format) fail("header names no format that is known: ascii or binary, 1.0");
}

void PlyParser::read_property(const std::vector<std::string_view>& words) {
  const bool list = words.size() == 5 && words[1] == "list";
  if (elements_.empty() || !(list || words.size() == 3)) fail("header: a property is malformed");
  Property property;
  property.name = words.back();
  property.type = scalar_type(words[words.size() - 2]);
  if (list) property.count_type = scalar_type(words[2]);
  if (!is_known(property.type) || (list && !is_known(property.count_type)))
    fail("header: property '" + file::shown(property.name) + "' has an unknown type");
  if (list && property.count_type.kind == 'F')
    fail("header: the length of list '" + file::shown(property.name) + "' is not an integer");
  elements_.back().properties.push_back(std::move(property));
}

const Element& PlyParser::vertex_element() {
  const auto vertices = std::find_if(elements_.begin(), elements_.end(),
                                     [](const Element& e) { return e.name == "vertex"; });
  if (vertices == elements_.end()) fail("has no element vertex");
  std::array<Property*, 6> found{};
  for (Property& property : vertices->properties) {
    for (std::size_t c = 0; c < kColumns.size(); ++c) {
      if (property.name == kColumns[c] && property.count_type.size == 0) found[c] = &property;
    }
  }
  for (std::size_t c = 0; c < 3; ++c) {
    if (found[c] == nullptr) fail(std::string("vertices have no property ") + kColumns[c]);
  }
  has_normals_ = found[3] && found[4] && found[5];
  for (std::size_t c = 0; c < (has_normals_ ? 6U : 3U); ++c) found[c]->column = static_cast<int>(c);
  if (vertices->count == 0) fail("holds no points");
  points_.are_float32 = !ascii_ && found[0]->type.kind == 'F' && found[0]->type.size == 4;
  if (vertices->count > kMaxPoints) {
    fail("header promises " + std::to_string(vertices->count) + " vertices; at most " +
         std::to_string(kMaxPoints) + " are read");
  }
  return *vertices;
}

void PlyParser::check_count(const Element& element) const {
  std::uint64_t least = 0;  // bytes of a row whose lists are empty
  for (const Property& property : element.properties) {
    const bool list = property.count_type.size > 0;
    least += ascii_ ? 2 : list ? property.count_type.size : property.type.size;
  }
  if (element.count == 0) return;
  if (least == 0) fail("element '" + file::shown(element.name) + "' has no properties");
  if (element.count > (bytes_.size() - at_ + 1) / least) {
    fail("is truncated: " + std::to_string(element.count) + " of element '" +
         file::shown(element.name) + "' cannot fit into the file");
  }
}

double PlyParser::read_value(ScalarType type, const Element& element, std::uint64_t row) {
  if (ascii_) {
    if (word_ == row_.size())
      fail(where(element, row) + " has fewer numbers in its line than the header says");
    const std::string_view word = row_[word_++];
    const std::optional<double> number = file::to_number(word);
    if (!number) fail(where(element, row) + ": '" + file::shown(word) + "' is not a number");
    return *number;
  }
  if (type.size > bytes_.size() - at_) fail("is truncated at " + where(element, row));
  const double value = read_scalar(bytes_.data() + at_, type, big_endian_);
  at_ += type.size;
  return value;
}

void PlyParser::read_row(const Element& element, std::uint64_t row, bool keep) {
  if (ascii_) {
    row_ = cursor_.row();
    word_ = 0;
    at_ = cursor_.offset();
    if (row_.empty()) fail("is truncated at " + where(element, row));
  }
  for (const Property& property : element.properties) {
    if (property.count_type.size == 0) {
      const double value = read_value(property.type, element, row);
      if (keep && property.column >= 0) store(property.column, row, value);
      continue;
    }
    const double length = read_value(property.count_type, element, row);
    if (!(length >= 0) || length != std::floor(length))
      fail("is corrupt: a list of " + where(element, row) + " has no sound length");
    for (double i = 0; i < length; ++i) read_value(property.type, element, row);
  }
  if (ascii_ && word_ < row_.size())
    fail(where(element, row) + " has more numbers in its line than the header says");
}

void PlyParser::store(int column, std::uint64_t row, double value) {
  Vec3& vector = column < 3 ? points_.positions[row] : points_.normals[row];
  (column % 3 == 0 ? vector.x : column % 3 == 1 ? vector.y : vector.z) = value;
}

}  // namespace

PointSet parse_ply_points(std::span<const std::byte> bytes, const std::string& name) {
  return PlyParser(bytes, name).parse();
}

}  // namespace vpm
