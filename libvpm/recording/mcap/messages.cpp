#include "libvpm/recording/mcap/messages.h"

#include <nlohmann/json.hpp>

#include "libvpm/file/text.h"
#include "libvpm/import/scan_facts.h"
#include "libvpm/recording/pose_line.h"
#include "libvpm/recording/pose_numbers.h"

namespace vpm::mcap {
namespace {

constexpr std::size_t kConfiguration = 12;  // bytes before the PNG of a compressedDepth, for floats

std::string read_frame(ByteCursor& cursor) {
  const std::string name = cursor.text();
  return name.starts_with('/') ? name.substr(1) : name;  // as ROS 1 wrote some
}

Header read_header(ByteCursor& cursor) {
  const auto seconds = cursor.number<std::int32_t>();
  const auto nanoseconds = cursor.number<std::uint32_t>();
  return {
      seconds < 0 ? 0 : kNanosecondsPerSecond * static_cast<std::uint64_t>(seconds) + nanoseconds,
      read_frame(cursor)};
}

// Returns the rows of an image as an array of NumPy, without what pads them.
std::vector<std::byte> array_of(ByteCursor& cursor) {
  const std::uint64_t height = cursor.number<std::uint32_t>(),
                      width = cursor.number<std::uint32_t>();
  const std::string coding = cursor.text();
  if (!is_of_depths(kImage, coding))
    throw Damage("an image of " + file::shown(coding) + ", not of 16UC1 or 32FC1 as depths are");
  const bool are_floats = coding == "32FC1", is_big_endian = cursor.number<std::uint8_t>() != 0;
  const std::uint64_t row = width * (are_floats ? 4 : 2), step = cursor.number<std::uint32_t>();
  const Bytes data = cursor.data();
  if (row == 0 || height == 0 || step < row || data.size() < step * (height - 1) + row)
    throw Damage("an image of " + std::to_string(width) + " x " + std::to_string(height) +
                 " pixels in rows of " + std::to_string(step) + " bytes is not in its " +
                 std::to_string(data.size()) + " bytes: the message is damaged");
  using namespace std::string_literals;
  std::string start = "\x93NUMPY\1\0v\0{'descr': '"s + (is_big_endian ? ">" : "<") +
                      (are_floats ? "f4" : "u2") + "', 'fortran_order': False, 'shape': (" +
                      std::to_string(height) + ", " + std::to_string(width) + ")}";
  start.resize(127, ' ');
  start += '\n';
  std::vector<std::byte> array(start.size() + row * height);
  auto to = std::ranges::copy(std::as_bytes(std::span(start)), array.begin()).out;
  for (std::uint64_t v = 0; v < height; ++v)
    to = std::ranges::copy(data.subspan(v * step, row), to).out;
  return array;
}

}  // namespace

ImageKind read_image_kind(const std::string& type, Bytes message) {
  ByteCursor cursor = ByteCursor::of_message(message);
  Header header = read_header(cursor);
  for (int k = 0; type == kImage && k < 2; ++k) cursor.number<std::uint32_t>();  // its size
  return {std::move(header), cursor.text()};
}

bool is_of_depths(const std::string& type, const std::string& coding) {
  if (type == kImage) return coding == "16UC1" || coding == "32FC1" || coding == "mono16";
  return type == kCompressedImage && coding.find("compressedDepth") != coding.npos &&
         !coding.ends_with("rvl");
}

std::vector<std::byte> image_file(const std::string& type, Bytes message) {
  ByteCursor cursor = ByteCursor::of_message(message);
  read_header(cursor);
  if (type == kImage) return array_of(cursor);
  const bool are_millimetres = cursor.text().starts_with("16UC1");
  Bytes data = cursor.data();
  if (are_millimetres) data = data.subspan(std::min(data.size(), kConfiguration));
  return {data.begin(), data.end()};
}

IntrinsicsFile read_camera_info(Bytes message, const std::string& name) {
  ByteCursor cursor = ByteCursor::of_message(message);
  const auto next = [&] { return cursor.number<std::uint32_t>(); };
  read_header(cursor);
  const std::uint32_t height = next(), width = next();
  cursor.text();  // the model of the distortion
  nlohmann::json lists{{"d", cursor.numbers(next())}};
  for (const auto& [key, count] : {std::pair{"k", 9}, {"r", 9}, {"p", 12}})
    lists[key] = cursor.numbers(count);
  const std::string text = lists.dump();
  const std::uint32_t across = std::max(1U, next()), down = std::max(1U, next());  // binning
  const std::uint32_t left = next(), top = next(), rows = next(), columns = next();
  IntrinsicsFile file = parse_intrinsics(std::as_bytes(std::span(text)), name);
  file.width = (columns > 0 ? columns : width) / across;  // zeros stand for the whole image
  file.height = (rows > 0 ? rows : height) / down;
  if (left == 0 && top == 0 && file.width == width && file.height == height) return file;
  // The centre of the first pixel is 0; one that is binned lies in the middle of several.
  Intrinsics& k = file.intrinsics;
  k = {k.fx / across, k.fy / down, (k.cx - left + 0.5) / across - 0.5,
       (k.cy - top + 0.5) / down - 0.5};
  file.remarks.push_back(
      {false, "its region of interest and binning make the intrinsics " + intrinsics_text(k)});
  return file;
}

StampedPose read_pose(Bytes message) {
  ByteCursor cursor = ByteCursor::of_message(message);
  return {read_header(cursor), {}, cursor.numbers(kQuaternionPose)};
}

std::vector<StampedPose> read_transforms(Bytes message) {
  ByteCursor cursor = ByteCursor::of_message(message);
  std::vector<StampedPose> transforms;
  for (auto left = cursor.number<std::uint32_t>(); left > 0; --left)
    transforms.push_back(
        {read_header(cursor), read_frame(cursor), cursor.numbers(kQuaternionPose)});
  return transforms;
}

}  // namespace vpm::mcap
