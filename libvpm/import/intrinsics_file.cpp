#include "libvpm/import/intrinsics_file.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "libvpm/core/error.h"
#include "libvpm/file/json_text.h"
#include "libvpm/file/text.h"
#include "libvpm/import/scan_facts.h"

namespace vpm {
namespace {

using nlohmann::json;

// Object of a calibration that holds intrinsics, and the keys that lead to it.
struct Candidate {
  std::string path;
  IntrinsicsFile file;
};

std::optional<double> number_at(const json& object, std::initializer_list<const char*> keys) {
  for (const char* key : keys) {
    const auto found = object.find(key);
    if (found != object.end() && found->is_number()) return found->get<double>();
  }
  return std::nullopt;
}

// Returns the numbers of a list, of a list of lists, or of an object's "data".
std::vector<double> numbers_of(const json& value) {
  if (value.is_object())
    return value.contains("data") ? numbers_of(value["data"]) : std::vector<double>{};
  std::vector<double> numbers;
  if (value.is_number()) numbers.push_back(value.get<double>());
  if (!value.is_array()) return numbers;
  for (const json& item : value) {
    if (item.is_object()) return {};
    const std::vector<double> more = numbers_of(item);
    numbers.insert(numbers.end(), more.begin(), more.end());
  }
  return numbers;
}

// Returns the intrinsics of a matrix of 3x3 by rows or columns, or 3x4 by rows.
std::optional<Intrinsics> from_matrix(std::vector<double> m, Remarks& remarks) {
  if (m.size() == 12) m = {m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10]};
  if (m.size() != 9 || m[8] != 1) return std::nullopt;
  if (m[2] == 0 && m[5] == 0 && (m[6] != 0 || m[7] != 0)) {  // stored by columns
    std::swap(m[2], m[6]);
    std::swap(m[5], m[7]);
    std::swap(m[1], m[3]);
  }
  if (m[3] != 0 || m[6] != 0 || m[7] != 0) return std::nullopt;
  if (m[1] != 0) remarks.push_back({true, "the skew in its matrix is not used"});
  return Intrinsics{m[0], m[4], m[2], m[5]};
}

std::optional<Intrinsics> from_numbers(const json& object) {
  const auto fx = number_at(object, {"fx", "fl_x", "Camera.fx", "Camera1.fx", "focal_x"}),
             fy = number_at(object, {"fy", "fl_y", "Camera.fy", "Camera1.fy", "focal_y"}),
             cx = number_at(object, {"cx", "ppx", "Camera.cx", "Camera1.cx"}),
             cy = number_at(object, {"cy", "ppy", "Camera.cy", "Camera1.cy"});
  if (!fx || !fy || !cx || !cy) return std::nullopt;
  return Intrinsics{*fx, *fy, *cx, *cy};
}

std::optional<Intrinsics> from_matrices(const json& object, Remarks& remarks) {
  for (const char* key : {"K", "k", "camera_matrix", "intrinsic_matrix", "cam_K", "Camera.K"}) {
    if (!object.contains(key)) continue;
    if (const auto found = from_matrix(numbers_of(object[key]), remarks)) return found;
  }
  return std::nullopt;
}

// Returns true if the object has coefficients of a distortion that does something.
bool has_distortion(const json& object) {
  for (const char* key :
       {"distortion_coefficients", "D", "d", "coeffs", "dist_coeffs", "distortion"}) {
    if (!object.contains(key)) continue;
    const std::vector<double> values = numbers_of(object[key]);
    if (std::any_of(values.begin(), values.end(), [](double value) { return value != 0; }))
      return true;
  }
  return false;
}

// Returns the intrinsics of the rectified image, the left 3x3 of ROS' projection matrix P, if it is
// told.
std::optional<Intrinsics> rectified(const json& object) {
  for (const char* key : {"P", "p", "projection_matrix"}) {
    if (!object.contains(key)) continue;
    Remarks of_p;
    const auto found = from_matrix(numbers_of(object[key]), of_p);
    if (found && are_sound(*found)) return found;
  }
  return std::nullopt;
}

bool are_same(const Intrinsics& a, const Intrinsics& b) {
  return a.fx == b.fx && a.fy == b.fy && a.cx == b.cx && a.cy == b.cy;
}

// Takes the intrinsics of the rectified image where the lens distorts, and says which were taken.
void choose_rectified(const json& object, IntrinsicsFile& file) {
  const std::optional<Intrinsics> p = rectified(object);
  const bool differs = p && !are_same(*p, file.intrinsics);
  if (!has_distortion(object)) {
    if (differs)
      file.remarks.push_back({false, "its K is used, " + intrinsics_text(file.intrinsics) +
                                         "; if the image is rectified, give `intrinsics` " +
                                         intrinsics_text(*p) + ", its P"});
    return;
  }
  if (differs) {
    file.remarks.push_back({true,
                            "the lens distorts, so that the depth image must be a rectified "
                            "one: its P is used, " +
                                intrinsics_text(*p) + ", which holds for that, and not its K, " +
                                intrinsics_text(file.intrinsics)});
    file.intrinsics = *p;
    return;
  }
  file.remarks.push_back(
      {true, "the lens's distortion in it is not used: the depth image must be a rectified one"});
}

std::uint32_t size_at(const json& object, std::initializer_list<const char*> keys) {
  const double size = number_at(object, keys).value_or(0);
  return size >= 1 && size <= 1e9 ? static_cast<std::uint32_t>(size) : 0;
}

// Returns the region of interest of ROS' camera_info; empty where it is the whole image.
std::optional<ImageRegion> region_of(const json& object) {
  const auto found = object.find("roi");
  if (found == object.end() || !found->is_object()) return std::nullopt;
  const ImageRegion region{size_at(*found, {"x_offset"}), size_at(*found, {"y_offset"}),
                           size_at(*found, {"width"}), size_at(*found, {"height"})};
  return region.width > 0 && region.height > 0 ? std::optional(region) : std::nullopt;
}

// Appends the objects in `value` that hold intrinsics. The parser has limited its depth.
void find_candidates(const json& value, const std::string& path, std::vector<Candidate>& found) {
  if (value.is_array())
    for (const json& item : value) find_candidates(item, path + "[]", found);
  if (!value.is_object()) return;
  Candidate candidate{path, {}};
  std::optional<Intrinsics> intrinsics = from_numbers(value);
  if (!intrinsics) intrinsics = from_matrices(value, candidate.file.remarks);
  if (intrinsics) {
    candidate.file.intrinsics = *intrinsics;
    candidate.file.width = size_at(value, {"width", "image_width", "xres", "w", "Camera.width"});
    candidate.file.height =
        size_at(value, {"height", "image_height", "yres", "h", "Camera.height"});
    candidate.file.region = region_of(value);
    choose_rectified(value, candidate.file);
    found.push_back(std::move(candidate));
    return;
  }
  for (const auto& [key, item] : value.items())
    find_candidates(item, path.empty() ? key : path + "." + key, found);
}

IntrinsicsFile chosen(const std::vector<Candidate>& candidates, const std::string& name) {
  if (candidates.empty())
    refuse("no camera's intrinsics in it", name,
           "it needs fx, fy, cx and cy, or a matrix K, camera_matrix or intrinsic_matrix");
  if (candidates.size() == 1) return candidates.front().file;
  std::vector<const Candidate*> depth;
  std::string paths;
  for (const Candidate& candidate : candidates) {
    if (file::in_lower_case(candidate.path).find("depth") != std::string::npos)
      depth.push_back(&candidate);
    paths += (paths.empty() ? "" : ", ") + file::shown(candidate.path, 40);
  }
  if (depth.size() != 1)
    refuse("it holds several cameras: " + file::shown(paths, 200), name,
           "give the numbers of one as `intrinsics` fx,fy,cx,cy");
  return depth.front()->file;
}

// Returns the numbers of a text that holds nothing else; empty otherwise.
std::vector<double> plain_numbers(std::string_view text) {
  std::vector<double> numbers;
  file::TextCursor cursor(text);
  while (const auto line = cursor.line()) {
    std::string row(line->substr(0, line->find('#')));
    for (char& c : row)
      if (c == ',' || c == ';' || c == '[' || c == ']') c = ' ';
    for (const std::string_view word : file::split_words(row)) {
      const std::optional<double> number = file::to_number(word);
      if (!number) return {};
      numbers.push_back(*number);
    }
  }
  return numbers;
}

json parse_calibration(std::string_view text, const std::string& name) {
  const std::size_t first = std::min(text.find_first_not_of(" \t\r\n"), text.size());
  if (!text.substr(first).starts_with('{')) return parse_yaml(text, name);
  try {
    return file::parse_json(text);
  } catch (const Error& fault) {
    refuse(fault.problem(), name);
  }
}

}  // namespace

IntrinsicsFile parse_intrinsics(std::span<const std::byte> bytes, const std::string& name) {
  constexpr std::size_t kLargest = std::size_t{1} << 20;  // bytes
  const std::string_view text = file::as_text(bytes);
  if (text.size() > kLargest || text.find('\0') != text.npos)
    refuse("not a text with a camera's intrinsics", name);
  const std::vector<double> n = plain_numbers(text);
  IntrinsicsFile read;
  if (n.size() == 4) {
    read.intrinsics = {n[0], n[1], n[2], n[3]};
  } else if (!n.empty()) {
    const auto found = from_matrix(n, read.remarks);
    if (!found)
      refuse("its " + std::to_string(n.size()) +
                 " numbers are neither fx fy cx cy nor a matrix fx 0 cx 0 fy cy 0 0 1",
             name);
    read.intrinsics = *found;
  } else {
    std::vector<Candidate> candidates;
    find_candidates(parse_calibration(text, name), "", candidates);
    read = chosen(candidates, name);
  }
  if (!are_sound(read.intrinsics))
    refuse("its focal lengths are not greater than 0, or its numbers are too large", name);
  return read;
}

}  // namespace vpm
