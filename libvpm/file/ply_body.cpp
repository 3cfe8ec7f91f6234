#include "libvpm/file/ply_body.h"

#include <cmath>
#include <cstddef>

#include "libvpm/core/error.h"
#include "libvpm/file/text.h"

namespace vpm::file {

PlyBody::PlyBody(std::string_view bytes, const PlyHeader& header, const std::string& name)
    : bytes_(bytes),
      header_(header),
      name_(name),
      at_(header.body),
      lines_(without_padding(bytes), name, 0) {
  while (is_text() && lines_.line_number() < header.lines) lines_.next_line();
}

void PlyBody::begin_record() {
  if (is_text()) lines_.require_line("another element");
}

void PlyBody::end_record() {
  if (!is_text() || lines_.rest().empty()) return;
  if (longer_ == 0) first_longer_ = lines_.line_number();
  ++longer_;
}

double PlyBody::value(ScalarType type) {
  if (is_text()) return lines_.number("a value");
  if (bytes_.size() - at_ < type.size) {
    refuse("the file ends at byte " + std::to_string(bytes_.size()) +
               " within an element; it is truncated",
           name_);
  }
  const auto* const from = reinterpret_cast<const std::byte*>(bytes_.data()) + at_;
  at_ += type.size;
  return read_scalar(from, type, header_.encoding == PlyEncoding::big_endian);
}

std::uint64_t PlyBody::length(const PlyProperty& list) {
  const double length = value(list.length_type);
  if (!(length >= 0) || length != std::floor(length) || length > 4294967295.0)
    refuse_here("the length of a list is not a whole number");
  const auto count = static_cast<std::uint64_t>(length);
  if (!is_text() && count > (bytes_.size() - at_) / list.type.size) {
    refuse_here("a list of " + std::to_string(count) +
                " values is longer than the rest of the file");
  }
  return count;
}

void PlyBody::skip(const PlyProperty& property) {
  const std::uint64_t count = property.is_list() ? length(property) : 1;
  for (std::uint64_t k = 0; k < count; ++k) value(property.type);
}

std::string PlyBody::place() const {
  return is_text() ? "in line " + std::to_string(lines_.line_number())
                   : "at byte " + std::to_string(at_);
}

// Moves to what follows the last record and returns it; empty if nothing does but the end of a line
// or padding.
std::string_view PlyBody::rest() {
  if (is_text()) return lines_.next_line() ? lines_.rest() : std::string_view();
  const std::string_view rest = bytes_.substr(at_);
  return is_padding(rest) ? std::string_view() : rest;
}

std::vector<std::string> PlyBody::unread() {
  std::vector<std::string> notes;
  if (longer_ > 0) {
    const std::string line = "line " + std::to_string(first_longer_);
    notes.push_back(
        (longer_ == 1 ? line + " holds"
                      : std::to_string(longer_) + " lines, the first of them " + line + ", hold") +
        " more numbers than the header says; they are not read");
  }
  const std::string_view more = rest();
  if (more.empty()) return notes;
  if (looks_like_ply(more) || is_word(more, "ply")) {
    notes.push_back("another PLY file follows " + place() + ", which is not read");
    return notes;
  }
  const PlyElement& last = header_.elements.back();
  const std::string count = std::to_string(last.count);
  notes.push_back("the header counts " +
                  (is_word(last.name, "face") ? count + (last.count == 1 ? " face" : " faces")
                                              : count + " x " + shown(last.name, 40)) +
                  ", but " +
                  (is_text() ? "more follows " + place() + ", which is not read"
                             : std::to_string(more.size()) + " bytes more follow " + place() +
                                   ", which are not read"));
  return notes;
}

void PlyBody::refuse_here(const std::string& defect) const {
  if (is_text()) lines_.refuse_here(defect);
  refuse(defect, name_ + ": at byte " + std::to_string(at_));
}

}  // namespace vpm::file
