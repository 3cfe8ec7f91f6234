#include <algorithm>
#include <array>
#include <cctype>
#include <cstring>
#include <optional>
#include <vector>

#include "libvpm/core/error.h"
#include "libvpm/file/scalar_type.h"
#include "libvpm/file/text.h"
#include "libvpm/file/text_lines.h"
#include "libvpm/import/point_files.h"

namespace vpm {

bool decode_lzf(std::span<const std::byte> from, std::span<std::byte> to) {
  constexpr std::size_t kLiteralLimit = 32;  // control bytes below it begin a run of literals
  constexpr std::size_t kLongLength = 7;     // a length that continues in another byte
  std::size_t in = 0, out = 0;
  while (in < from.size()) {
    const auto control = std::to_integer<std::size_t>(from[in++]);
    if (control < kLiteralLimit) {
      const std::size_t run = control + 1;
      if (run > from.size() - in || run > to.size() - out) return false;
      std::copy_n(from.begin() + static_cast<std::ptrdiff_t>(in), run,
                  to.begin() + static_cast<std::ptrdiff_t>(out));
      in += run;
      out += run;
      continue;
    }
    std::size_t length = control >> 5;
    if (length == kLongLength) {
      if (in == from.size()) return false;
      length += std::to_integer<std::size_t>(from[in++]);
    }
    length += 2;
    if (in == from.size()) return false;
    const std::size_t back = ((control & 31) << 8) + std::to_integer<std::size_t>(from[in++]) + 1;
    if (back > out || length > to.size() - out) return false;
    // Copies byte by byte, since a reference may overlap its output.
    for (std::size_t i = 0; i < length; ++i, ++out) to[out] = to[out - back];
  }
  return out == to.size();
}

namespace {

struct Field {
  std::string name;
  file::ScalarType type;
  std::uint64_t count = 1;   // values of the field per point
  std::uint64_t offset = 0;  // bytes from the start of a point
  std::uint64_t first = 0;   // index of its first value in a point
};

struct Header {
  std::vector<Field> fields;
  std::uint64_t width = 0, height = 1, points = 0;
  std::uint64_t point_size = 0, point_values = 0;
  std::optional<Pose> viewpoint;
  Vec3 origin;  // is added to each point (cloud_export.h says why)
  std::string encoding;
};

// Limits fields and values per point, far above any sensor's, so that products of sizes cannot
// overflow.
constexpr std::uint64_t kMaxFields = 4096;

std::string in_capitals(std::string_view word) {
  std::string capitals(word);
  std::transform(word.begin(), word.end(), capitals.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return capitals;
}

class PcdParser {
 public:
  PcdParser(std::string_view bytes, const std::string& name)
      : bytes_(bytes), name_(name), cursor_(bytes) {}

  PointSet parse() {
    read_header();
    find_columns();
    points_.width = static_cast<std::uint32_t>(header_.width);
    points_.height = static_cast<std::uint32_t>(header_.height);
    points_.viewpoint = header_.viewpoint;
    if (header_.encoding == "ascii") read_ascii();
    if (header_.encoding == "binary") read_binary();
    if (header_.encoding == "binary_compressed") read_compressed();
    for (Vec3& p : points_.positions) p = p + header_.origin;
    say_unread();
    return std::move(points_);
  }

 private:
  [[noreturn]] void fail(const std::string& defect) const { refuse("PCD " + defect, name_); }

  void read_header();
  void read_entry(const std::vector<std::string_view>& words);
  void read_fields(const std::vector<std::string_view>& words);
  void read_viewpoint(const std::vector<std::string_view>& words);
  void read_origin(const std::vector<std::string_view>& words);
  void check_header();
  void find_columns();
  void allocate();
  void read_ascii();
  void read_binary();
  void read_compressed();
  void say_unread();
  // Reads the values of all points: field f of point i is at `data + start[f] + i * step[f]`.
  void read_values(const std::byte* data, bool by_field);
  std::uint64_t count_of(std::string_view word, const std::string& entry) const;

  std::string_view bytes_;
  const std::string& name_;
  file::TextCursor cursor_;
  std::size_t end_ = 0;  // offset of the first byte after the points
  Header header_;
  std::array<const Field*, kPointColumns> column_{};
  PointSet points_;
};

std::uint64_t PcdParser::count_of(std::string_view word, const std::string& entry) const {
  const std::optional<std::uint64_t> count = file::to_count(word);
  if (!count) fail("header: '" + file::shown(word) + "' in " + entry + " is not a count");
  return *count;
}

void PcdParser::read_header() {
  while (header_.encoding.empty()) {
    const std::optional<std::string_view> line = cursor_.line();
    if (!line) fail("header ends before its DATA line");
    const std::vector<std::string_view> words = file::split_words(*line);
    if (words.size() == 6 && words[0] == "#" && words[1] == "vpm" && words[2] == "origin")
      read_origin(words);
    if (words.empty() || words[0].front() == '#') continue;
    if (words.size() < 2) fail("header: '" + file::shown(words[0]) + "' has no value");
    read_entry(words);
  }
  check_header();
}

void PcdParser::read_entry(const std::vector<std::string_view>& words) {
  const std::string entry = in_capitals(words[0]);
  if (entry == "VERSION") {
    const std::string_view version = words[1].substr(words[1].find('.') + 1);
    if (version != "7" && version != "6")
      fail("version " + file::shown(words[1]) + " is not known; write version 0.7");
  } else if (entry == "FIELDS" || entry == "COLUMNS" || entry == "SIZE" || entry == "TYPE" ||
             entry == "COUNT") {
    read_fields(words);
  } else if (entry == "WIDTH") {
    header_.width = count_of(words[1], entry);
  } else if (entry == "HEIGHT") {
    header_.height = count_of(words[1], entry);
  } else if (entry == "POINTS") {
    header_.points = count_of(words[1], entry);
  } else if (entry == "VIEWPOINT") {
    read_viewpoint(words);
  } else if (entry == "DATA") {
    header_.encoding = file::in_lower_case(words[1]);
  } else {
    fail("header: unknown entry '" + file::shown(words[0]) + "'");
  }
}

void PcdParser::read_fields(const std::vector<std::string_view>& words) {
  const std::string entry = in_capitals(words[0]);
  const std::size_t count = words.size() - 1;
  if (entry == "FIELDS" || entry == "COLUMNS") {
    if (count > kMaxFields) fail("header: " + std::to_string(count) + " fields are too many");
    header_.fields.resize(count);
  }
  if (count != header_.fields.size()) {
    fail("header: " + entry + " names " + std::to_string(count) + " fields, FIELDS " +
         std::to_string(header_.fields.size()));
  }
  for (std::size_t i = 0; i < count; ++i) {
    Field& field = header_.fields[i];
    const std::string_view word = words[i + 1];
    if (entry == "SIZE") {
      field.type.size =
          static_cast<std::uint8_t>(std::min<std::uint64_t>(count_of(word, entry), 255));
    } else if (entry == "TYPE") {
      field.type.kind = word.size() == 1 ? in_capitals(word)[0] : '?';
    } else if (entry == "COUNT") {
      field.count = count_of(word, entry);
      if (field.count > kMaxFields)
        fail("header: a COUNT of " + file::shown(word) + " is too large");
    } else {
      field.name = word;
    }
  }
}

void PcdParser::read_viewpoint(const std::vector<std::string_view>& words) {
  // Some writers know no pose and fill the line with zeros, not always seven.
  if (std::all_of(words.begin() + 1, words.end(),
                  [](std::string_view word) { return file::to_number(word) == 0; }))
    return;
  double n[7];
  if (words.size() != 8) fail("header: VIEWPOINT needs 7 numbers: tx ty tz qw qx qy qz");
  for (std::size_t i = 0; i < 7; ++i) {
    const std::optional<double> number = file::to_number(words[i + 1]);
    if (!number) fail("header: '" + file::shown(words[i + 1]) + "' in VIEWPOINT is not a number");
    n[i] = *number;
  }
  Pose viewpoint;
  viewpoint.translation = {n[0], n[1], n[2]};
  if (!is_finite(viewpoint.translation)) fail("header: VIEWPOINT is not finite");
  try {
    viewpoint.rotation = rotation_from_quaternion({n[4], n[5], n[6], n[3]});
  } catch (const Error& fault) {
    refuse("PCD header: VIEWPOINT: " + fault.problem(), name_,
           "give tx ty tz qw qx qy qz of a unit quaternion");
  }
  header_.viewpoint = viewpoint;
}

// Reads "# vpm origin X Y Z", the place that cloud_export.h writes points about.
void PcdParser::read_origin(const std::vector<std::string_view>& words) {
  const auto number = [&](std::size_t k) { return file::to_number(words[k]).value_or(0); };
  header_.origin = {number(3), number(4), number(5)};
  if (!is_finite(header_.origin)) fail("header: its origin is not finite");
}

void PcdParser::check_header() {
  Header& h = header_;
  if (h.fields.empty()) fail("header names no FIELDS");
  for (Field& field : h.fields) {
    if (!file::is_known(field.type)) {
      fail("header: field '" + file::shown(field.name) + "' has TYPE " +
           file::shown({&field.type.kind, 1}) + " of SIZE " + std::to_string(field.type.size) +
           ", which is no number");
    }
    field.offset = h.point_size;
    field.first = h.point_values;
    h.point_size += field.type.size * field.count;
    h.point_values += field.count;
  }
  if (h.width == 0 && h.height == 1) h.width = h.points;
  if (h.points == 0 && h.width <= kMaxPoints && h.height <= kMaxPoints)
    h.points = h.width * h.height;
  if (h.points > kMaxPoints || h.width > kMaxPoints || h.height > kMaxPoints) {
    fail("header promises " + std::to_string(std::max({h.points, h.width, h.height})) +
         " points; at most " + std::to_string(kMaxPoints) + " are read");
  }
  if (h.points == 0) fail("holds no points");
  if (h.width * h.height != h.points) {
    fail("header: WIDTH " + std::to_string(h.width) + " times HEIGHT " + std::to_string(h.height) +
         " is not POINTS " + std::to_string(h.points));
  }
  if (h.encoding != "ascii" && h.encoding != "binary" && h.encoding != "binary_compressed")
    fail("header: DATA '" + file::shown(h.encoding) +
         "' is not ascii, binary or binary_compressed");
}

void PcdParser::find_columns() {
  std::vector<std::string> names;
  for (const Field& field : header_.fields)
    names.push_back(field.count == 1 ? field.name : std::string());
  const PointColumns columns = point_columns(names, name_);
  for (std::size_t c = 0; c < kPointColumns; ++c)
    if (columns[c]) column_[c] = &header_.fields[*columns[c]];
}

void PcdParser::allocate() {
  points_.positions.resize(header_.points);
  if (column_[3] != nullptr) points_.normals.resize(header_.points);
}

void PcdParser::read_ascii() {
  // A value takes a character and a blank; the last one perhaps no blank.
  if (header_.points > (cursor_.remaining() + 1) / 2 / header_.point_values)
    fail("is truncated: " + std::to_string(header_.points) + " points cannot fit into the file");
  allocate();
  for (std::size_t i = 0; i < header_.points; ++i) {
    const std::vector<std::string_view> words = cursor_.row();
    if (words.empty()) fail("is truncated at point " + std::to_string(i));
    if (words.size() != header_.point_values)
      fail("point " + std::to_string(i) + " has " + std::to_string(words.size()) +
           " numbers in its line, the header says " + std::to_string(header_.point_values));
    for (std::size_t c = 0; c < kPointColumns; ++c) {
      if (column_[c] == nullptr) continue;
      const std::string_view word = words[column_[c]->first];
      const std::optional<double> number = file::to_number(word);
      if (!number) {
        fail("point " + std::to_string(i) + ": '" + file::shown(word) + "' is not a number" +
             file::cure_of_number(word));
      }
      points_.at(c, i) = *number;
    }
  }
  end_ = cursor_.offset();
}

// Warns if bytes follow the points, such as another file joined to this one.
void PcdParser::say_unread() {
  std::string_view rest = bytes_.substr(end_);
  if (header_.encoding == "ascii") rest = file::without_padding(rest);
  if (file::is_padding(rest)) return;
  points_.remarks.push_back({true, "the header counts " + std::to_string(header_.points) +
                                       (header_.points == 1 ? " point" : " points") + ", but " +
                                       std::to_string(rest.size()) +
                                       " bytes more follow, which are not read"});
}

void PcdParser::read_values(const std::byte* data, bool by_field) {
  allocate();
  for (std::size_t c = 0; c < kPointColumns; ++c) {
    if (column_[c] == nullptr) continue;
    const Field& field = *column_[c];
    const std::byte* from = data + field.offset * (by_field ? header_.points : 1);
    const std::size_t step = by_field ? field.type.size : header_.point_size;
    for (std::size_t i = 0; i < header_.points; ++i)
      points_.at(c, i) = file::read_scalar(from + i * step, field.type, false);
  }
}

void PcdParser::read_binary() {
  const std::uint64_t size = header_.points * header_.point_size;
  if (size > cursor_.remaining()) {
    fail("is truncated: " + std::to_string(size) + " bytes of points promised, " +
         std::to_string(cursor_.remaining()) + " there");
  }
  read_values(reinterpret_cast<const std::byte*>(bytes_.data()) + cursor_.offset(), false);
  end_ = cursor_.offset() + size;
}

void PcdParser::read_compressed() {
  std::uint32_t sizes[2];  // compressed, uncompressed
  if (cursor_.remaining() < sizeof sizes) fail("is truncated before its compressed data");
  const std::string_view body = bytes_.substr(cursor_.offset());
  std::memcpy(sizes, body.data(), sizeof sizes);
  const std::uint64_t compressed = sizes[0], uncompressed = sizes[1];
  if (compressed > body.size() - sizeof sizes) {
    fail("is truncated: " + std::to_string(compressed) + " compressed bytes promised, " +
         std::to_string(body.size() - sizeof sizes) + " there");
  }
  if (uncompressed != header_.points * header_.point_size) {
    fail("holds " + std::to_string(uncompressed) + " bytes uncompressed; its points need " +
         std::to_string(header_.points * header_.point_size));
  }
  if (uncompressed > compressed * kMaxLzfRatio)
    fail("is corrupt: the compressed data is too short");
  std::vector<std::byte> data(uncompressed);
  if (!decode_lzf(std::as_bytes(std::span(body.substr(sizeof sizes, compressed))), data))
    fail("is corrupt: the compressed data cannot be decoded");
  read_values(data.data(), true);
  end_ = cursor_.offset() + sizeof sizes + compressed;
}

}  // namespace

PointSet parse_pcd(std::span<const std::byte> bytes, const std::string& name) {
  return PcdParser(file::without_byte_order_mark(file::as_text(bytes)), name).parse();
}

}  // namespace vpm
