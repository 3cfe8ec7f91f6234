#include "libvpm/import/intrinsics_file.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "libvpm/core/error.h"
#include "libvpm/file/npy.h"
#include "libvpm/file/sniff.h"
#include "libvpm/file/text.h"
#include "libvpm/import/calibration_fields.h"
#include "libvpm/import/calibration_text.h"
#include "libvpm/import/scan_facts.h"

namespace vpm {
namespace {

using nlohmann::json;

// Intrinsics of a calibration, and the keys that lead to them.
struct Candidate {
  std::string path;
  IntrinsicsFile file;
  std::string fault;  // why they do not serve; empty if they do
  std::string hint;   // how to mend that
};

// Returns the numbers of a list, of a list of lists, of an object's "data", or of a text "1 0 0".
std::vector<double> numbers_of(const json& value) {
  if (value.is_object())
    return value.contains("data") ? numbers_of(value["data"]) : std::vector<double>{};
  if (value.is_string()) return plain_numbers(value.get_ref<const std::string&>());
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

// Returns the left 3x3 of a matrix of 3x3, or of 3x4 or 4x4 by rows; other numbers as they are.
std::vector<double> upper_left(const std::vector<double>& m) {
  if (m.size() != 12 && m.size() != 16) return m;
  return {m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10]};
}

// True if what a matrix of 3x4 or 4x4 has beside its left 3x3 is that of the unit matrix.
bool has_unit_border(const std::vector<double>& m) {
  if (m.size() < 12) return true;
  const bool has_column = m[3] != 0 || m[7] != 0 || m[11] != 0;
  const bool has_row = m.size() == 16 && (m[12] != 0 || m[13] != 0 || m[14] != 0 || m[15] != 1);
  return !has_column && !has_row;
}

// Returns the intrinsics of a matrix of 3x3 by rows or columns, or of the left 3x3 of a larger one.
std::optional<Intrinsics> from_matrix(const std::vector<double>& numbers, Remarks& remarks) {
  std::vector<double> m = upper_left(numbers);
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

// Sets the candidate to the camera of a matrix; returns false if the numbers are none.
bool take_matrix(const std::vector<double>& numbers, Candidate& candidate) {
  const auto found = from_matrix(numbers, candidate.file.remarks);
  if (!found) return false;
  candidate.file.intrinsics = *found;
  if (has_unit_border(numbers)) return true;
  candidate.fault =
      "its matrix has a last column that is not 0, or a last row that is not 0 0 0 1, like that of "
      "another camera or a pose";
  candidate.hint =
      "if fx, fy, cx and cy are this image's, give `intrinsics` " + intrinsics_text(*found);
  return true;
}

// Sets the candidate to the camera of a list fx, fy, cx, cy, as Kalibr writes it beside the model;
// returns false if `numbers` are no such list.
bool take_list(const Fields& fields, const std::vector<double>& numbers, Candidate& candidate) {
  if (numbers.size() < 4 || numbers.size() > 8) return false;  // the models have as many
  const Fields::Field* const model = fields.find({"cameramodel"});
  if (model && model->value->is_string() &&
      file::in_lower_case(model->value->get_ref<const std::string&>()).find("pinhole") ==
          std::string::npos) {
    candidate.fault = "its camera_model is " +
                      file::shown(model->value->get_ref<const std::string&>()) +
                      ", and only pinhole is read";
    candidate.hint =
        "rectify the images and give the numbers of the camera that they have then "
        "as `intrinsics` fx,fy,cx,cy";
    return true;
  }
  if (numbers.size() != 4) return false;
  candidate.file.intrinsics = {numbers[0], numbers[1], numbers[2], numbers[3]};
  return true;
}

// Names of one camera's values in an object: "camera1." before fx, "1" behind the M of OpenCV's
// pairs of cameras.
struct Affixes {
  std::string before, behind;
};

// Sets the candidate to the camera of four numbers with names; returns false if one is missing.
bool take_numbers(const Fields& fields, const std::string& before, Candidate& candidate) {
  const auto fx = fields.number({before + "fx", before + "flx", before + "focalx"}),
             fy = fields.number({before + "fy", before + "fly", before + "focaly"}),
             cx = fields.number({before + "cx", before + "ppx"}),
             cy = fields.number({before + "cy", before + "ppy"});
  if (!fx || !fy || !cx || !cy) return false;
  candidate.file.intrinsics = {*fx, *fy, *cx, *cy};
  if (!fields.number({before + "fx"}) && fields.number({before + "flx"})) {
    candidate.file.intrinsics.cx -= 0.5;
    candidate.file.intrinsics.cy -= 0.5;
    candidate.file.remarks.push_back(
        {false,
         "fl_x is a key of nerfstudio, to which the first pixel's centre is 0.5, 0.5 and not "
         "0, 0: its intrinsics are " +
             intrinsics_text(candidate.file.intrinsics) + " here"});
  }
  return true;
}

// True for the numbers of a matrix that are all 0, as ROS publishes them of a camera that was never
// calibrated.
bool is_of_zeros(const std::vector<double>& m) {
  return (m.size() == 9 || m.size() == 12) &&
         std::ranges::all_of(m, [](double v) { return v == 0; });
}

// Sets the candidate to the first matrix, or list, of one camera; returns false if there is none.
bool take_matrices(const Fields& fields, const std::string& behind, Candidate& candidate) {
  const Fields::Field* of_zeros = nullptr;
  for (const char* key : {"k", "m", "cameramatrix", "intrinsicmatrix", "camk", "camera.k",
                          "intrinsics", "intrinsic", "p"}) {
    const Fields::Field* const field = fields.find({key + behind});
    if (!field) continue;
    const std::vector<double> numbers = numbers_of(*field->value);
    if (!of_zeros && is_of_zeros(numbers)) of_zeros = field;
    const bool is_list = std::string_view(key).starts_with("intrinsic");
    if (!take_matrix(numbers, candidate) && !(is_list && take_list(fields, numbers, candidate)))
      continue;
    if (!behind.empty()) candidate.path += (candidate.path.empty() ? "" : ".") + field->key;
    return true;
  }
  if (!of_zeros) return false;
  candidate.fault = "its " + file::shown(of_zeros->key) +
                    " is all zeros, as ROS publishes of a camera that was never calibrated";
  candidate.hint = "calibrate the camera, or give its numbers as `intrinsics` fx,fy,cx,cy";
  return true;
}

// True if the object has coefficients of a distortion that does something, in a list or each under
// its own key.
bool has_distortion(const Fields& fields, const Affixes& camera) {
  const auto does = [](double value) { return value != 0; };
  for (const char* key : {"distortioncoefficients", "distortioncoeffs", "distortionparams", "d",
                          "coeffs", "distcoeffs", "distortion"}) {
    const Fields::Field* const field = fields.find({key + camera.behind});
    if (!field) continue;
    const std::vector<double> values = numbers_of(*field->value);
    if (std::any_of(values.begin(), values.end(), does)) return true;
  }
  for (const char* key : {"k1", "k2", "k3", "k4", "k5", "k6", "p1", "p2"})
    if (does(fields.number({camera.before + key}).value_or(0))) return true;
  return false;
}

// Returns the intrinsics of the rectified image, the left 3x3 of ROS' projection matrix P, if it is
// told.
std::optional<Intrinsics> rectified(const Fields& fields, const std::string& behind) {
  for (const char* key : {"p", "projectionmatrix"}) {
    const Fields::Field* const field = fields.find({key + behind});
    if (!field) continue;
    Remarks of_p;
    const auto found = from_matrix(numbers_of(*field->value), of_p);
    if (found && are_sound(*found)) return found;
  }
  return std::nullopt;
}

bool are_same(const Intrinsics& a, const Intrinsics& b) {
  return a.fx == b.fx && a.fy == b.fy && a.cx == b.cx && a.cy == b.cy;
}

// Takes the intrinsics of the rectified image where the lens distorts, and says which were taken.
void choose_rectified(const Fields& fields, const Affixes& camera, IntrinsicsFile& file) {
  const std::optional<Intrinsics> p = rectified(fields, camera.behind);
  const bool differs = p && !are_same(*p, file.intrinsics);
  if (!has_distortion(fields, camera)) {
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

std::uint32_t as_size(double size) {
  return size >= 1 && size <= 1e9 ? static_cast<std::uint32_t>(size) : 0;
}

std::uint32_t size_at(const Fields& fields, const Fields::Keys& keys) {
  return as_size(fields.number(keys).value_or(0));
}

// Returns the region of interest of ROS' camera_info; empty where it is the whole image.
std::optional<ImageRegion> region_of(const Fields& fields) {
  const Fields::Field* const roi = fields.find({"roi"});
  if (!roi || !roi->value->is_object()) return std::nullopt;
  const Fields of(*roi->value);
  const ImageRegion region{size_at(of, {"xoffset"}), size_at(of, {"yoffset"}),
                           size_at(of, {"width"}), size_at(of, {"height"})};
  return region.width > 0 && region.height > 0 ? std::optional(region) : std::nullopt;
}

void read_size(const Fields& fields, IntrinsicsFile& file) {
  file.width = size_at(fields, {"width", "imagewidth", "xres", "w", "camera.width"});
  file.height = size_at(fields, {"height", "imageheight", "yres", "h", "camera.height"});
  const Fields::Field* const size = fields.find({"resolution"});  // Kalibr, EuRoC
  const std::vector<double> both = size ? numbers_of(*size->value) : std::vector<double>{};
  if (file.width > 0 || file.height > 0 || both.size() != 2) return;
  file.width = as_size(both[0]);
  file.height = as_size(both[1]);
}

void append_candidate(const Fields& fields, const Affixes& camera, Candidate candidate,
                      std::vector<Candidate>& found) {
  read_size(fields, candidate.file);
  candidate.file.region = region_of(fields);
  candidate.file.factor = depth_factor_in(fields);
  if (candidate.fault.empty()) choose_rectified(fields, camera, candidate.file);
  found.push_back(std::move(candidate));
}

// Appends the cameras whose values stand in an object itself: one whose keys have no number, or
// several of which each has its own.
void find_in_object(const Fields& fields, const std::string& path, std::vector<Candidate>& found) {
  const std::size_t before = found.size();
  for (const std::string prefix : {"", "camera.", "camera1.", "camera2."}) {
    Candidate candidate;
    candidate.path = path;
    if (!take_numbers(fields, prefix, candidate)) continue;
    if (!prefix.empty())
      candidate.path += (path.empty() ? "" : ".") + prefix.substr(0, prefix.find('.'));
    append_candidate(fields, {prefix, ""}, std::move(candidate), found);
  }
  for (const std::string suffix : {"", "0", "1", "2", "3", "4", "00", "01", "02", "03"}) {
    if (found.size() > before && (suffix.empty() || found.back().path == path)) return;
    Candidate candidate;
    candidate.path = path;
    if (take_matrices(fields, suffix, candidate))
      append_candidate(fields, {"", suffix}, std::move(candidate), found);
  }
}

// Appends the cameras in `value`. The parser has limited its depth.
void find_candidates(const json& value, const std::string& path, std::vector<Candidate>& found) {
  if (value.is_array())
    for (const json& item : value) find_candidates(item, path + "[]", found);
  if (!value.is_object()) return;
  const std::size_t before = found.size();
  find_in_object(Fields(value), path, found);
  if (found.size() > before) return;
  for (const auto& [key, item] : value.items())
    find_candidates(item, path.empty() ? key : path + "." + key, found);
}

bool are_same(const Candidate& a, const Candidate& b) {
  const auto units = [](const Candidate& c) {
    return c.file.factor ? c.file.factor->units_per_metre : 0;
  };
  return are_same(a.file.intrinsics, b.file.intrinsics) && a.file.width == b.file.width &&
         a.file.height == b.file.height && units(a) == units(b) && a.fault == b.fault;
}

// Returns the camera if there is only one, or if all are equal; null if they differ.
const Candidate* only(const std::vector<const Candidate*>& candidates) {
  const bool are_one = std::ranges::all_of(
      candidates, [&](const Candidate* other) { return are_same(*other, *candidates.front()); });
  return are_one && !candidates.empty() ? candidates.front() : nullptr;
}

// Returns the camera that is meant: the only one, the one that is called depth, or, where each
// image has its own, as in BOP's scene_camera.json, the one under the number in the image's name.
Candidate chosen(const std::vector<Candidate>& candidates, const std::string& name,
                 const std::string& image) {
  if (candidates.empty())
    refuse("no camera's intrinsics in it", name,
           "it needs fx, fy, cx and cy, or a matrix K, camera_matrix or intrinsic_matrix");
  const std::optional<std::uint64_t> number = file::number_in_name(image);
  std::vector<const Candidate*> all, depth, of_image;
  std::vector<std::string> paths;
  for (const Candidate& candidate : candidates) {
    all.push_back(&candidate);
    paths.push_back(candidate.path);
    if (file::in_lower_case(candidate.path).find("depth") != std::string::npos)
      depth.push_back(&candidate);
    const std::string key = candidate.path.substr(0, candidate.path.find('.'));
    if (number && file::to_count(key) == number) of_image.push_back(&candidate);
  }
  for (const auto& some : {all, depth})
    if (const Candidate* const found = only(some)) return *found;
  const Candidate* const found = only(of_image);
  if (found == nullptr)
    refuse("it holds several cameras: " + file::listed(paths), name,
           "give the numbers of one as `intrinsics` fx,fy,cx,cy");
  Candidate taken = *found;
  taken.file.remarks.push_back({false, "of its " + std::to_string(all.size()) +
                                           " cameras, that under the image's number, " +
                                           std::to_string(*number) + ", is taken"});
  return taken;
}

// Refuses what is no calibration by its first bytes.
void refuse_foreign(const std::optional<file::Content>& content, std::string_view text,
                    const std::string& name) {
  const std::string_view start =
      text.substr(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
  if (start.starts_with("<?xml") || start.starts_with("<opencv_storage"))
    refuse("this is XML, which is not read for intrinsics", name,
           "write it as .yml, which OpenCV does where the file's name ends so");
  if (content)
    refuse("this is " + content->what, name,
           content->holds == file::Holds::anything
               ? content->next
               : "write fx, fy, cx and cy of its camera in a text, or give them as `intrinsics` "
                 "fx,fy,cx,cy");
}

// Returns the numbers of an array of NumPy that has few enough to be a camera's.
std::vector<double> numbers_of_array(std::span<const std::byte> bytes, const std::string& name) {
  constexpr std::uint64_t kMost = 16;  // 4x4
  const file::NpyArray array = file::parse_npy(bytes, name);
  if (array.size == 0 || array.size > kMost)
    refuse("an array of " + file::shape_text(array.shape) + " is no camera's matrix", name,
           "save one of 3 x 3 numbers");
  std::vector<double> numbers;
  for (std::uint64_t k = 0; k < array.size; ++k) numbers.push_back(array.at(k));
  return numbers;
}

// Returns the camera of a text, or array, that holds numbers and nothing else.
Candidate from_numbers(const std::vector<double>& n, const std::string& name) {
  Candidate read;
  if (n.size() == 4)
    read.file.intrinsics = {n[0], n[1], n[2], n[3]};
  else if (!take_matrix(n, read))
    refuse("its " + std::to_string(n.size()) +
               " numbers are neither fx fy cx cy nor a matrix fx 0 cx 0 fy cy 0 0 1",
           name);
  return read;
}

// Returns the camera of a calibration in JSON or YAML.
Candidate from_calibration(std::string_view text, const std::string& name,
                           const std::string& image) {
  const json calibration = parse_calibration(text, name);
  std::vector<Candidate> candidates;
  find_candidates(calibration, "", candidates);
  Candidate read = chosen(candidates, name, image);
  if (!read.file.factor && calibration.is_object())
    read.file.factor = depth_factor_in(Fields(calibration));
  return read;
}

}  // namespace

IntrinsicsFile parse_intrinsics(std::span<const std::byte> bytes, const std::string& name,
                                const std::string& image) {
  constexpr std::size_t kLargest = std::size_t{1} << 20U;      // bytes
  constexpr std::size_t kLargestJson = std::size_t{1} << 24U;  // an entry for each image of many
  const std::string utf8 = file::utf8_of(file::as_text(bytes));
  const std::string_view text = file::without_byte_order_mark(utf8);
  const auto content = file::sniff(std::as_bytes(std::span(text.data(), text.size())));
  const bool is_array = content && content->scan == file::ScanFormat::npy;
  if (!is_array) refuse_foreign(content, text, name);
  const std::size_t first = std::min(text.find_first_not_of(" \t\r\n"), text.size());
  const std::size_t most = text.substr(first).starts_with('{') ? kLargestJson : kLargest;
  if (!is_array && (text.size() > most || text.find('\0') != text.npos))
    refuse("not a text with a camera's intrinsics", name);
  const std::vector<double> numbers =
      is_array ? numbers_of_array(bytes, name) : plain_numbers(text);
  const Candidate read =
      numbers.empty() ? from_calibration(text, name, image) : from_numbers(numbers, name);
  if (!read.fault.empty()) refuse(read.fault, name, read.hint);
  if (!are_sound(read.file.intrinsics))
    refuse("its focal lengths are not greater than 0, or its numbers are too large", name);
  return read.file;
}

}  // namespace vpm
