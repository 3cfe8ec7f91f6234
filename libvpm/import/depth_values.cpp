#include "libvpm/import/depth_values.h"

#include <algorithm>
#include <array>
#include <limits>

#include "libvpm/core/error.h"
#include "libvpm/file/text.h"
#include "libvpm/import/depth_suspicions.h"

namespace vpm {
namespace {

// The largest 16-bit integer, the largest half, Blender's background, the largest float.
constexpr std::array kUsualMarkers{65535.0F, 65504.0F, 1e10F, std::numeric_limits<float>::max()};

float decoded(float value, const DepthDecoding& decoding) {
  auto bits = static_cast<std::uint16_t>(value);
  if (decoding.swapped) bits = swapped(bits);
  if (decoding.rotated) bits = static_cast<std::uint16_t>((bits >> 3) | (bits << 13));
  if (!decoding.disparity) return bits;
  // Beyond 10 m, disparities of a Kinect tell nothing (toolbox of NYU Depth V2).
  constexpr double kNumerator = 351.3, kAtInfinity = 1092.5, kFarthest = 10;
  const double depth = kNumerator / (kAtInfinity - bits);
  return depth > 0 && depth <= kFarthest ? static_cast<float>(depth) : 0.0F;
}

bool decodes(const DepthDecoding& decoding) {
  return decoding.swapped || decoding.rotated || decoding.disparity;
}

// Replaces the values by what they code. Returns true if they look coded still.
bool decode(std::vector<float>& values, const RawDepth& raw, const DepthReading& reading,
            const std::string& name, Remarks& remarks) {
  if (decodes(reading.decoding)) {
    if (!raw.are_16_bit)
      throw Error(ErrorKind::invalid_argument,
                  "`decode` is for integers of 16 bits, which this image has not", name);
    for (float& value : values) value = decoded(value, reading.decoding);
    return false;
  }
  if (!raw.are_16_bit || !(reading.looks_for_mistakes || raw.may_be_swapped)) return false;
  if (look_swapped(values, raw.width)) {
    if (raw.may_be_swapped)
      for (float& value : values) value = decoded(value, {.swapped = true});
    remarks.push_back(
        raw.may_be_swapped
            ? Remark{false, "its values stand with the low byte first, and are read so"}
            : Remark{true,
                     "neighbouring values differ as if the order of their two bytes were wrong; if "
                     "so, give `decode` swapped"});
  }
  const Remarks suspicions = reading.looks_for_mistakes ? coding_suspicions(values) : Remarks{};
  append(remarks, suspicions);
  return !suspicions.empty();
}

// Sets markers to 0, and says which of the usual ones it met.
void remove_markers(std::vector<float>& values, const DepthReading& reading, Remarks& remarks) {
  std::vector<float> markers;
  for (const double value : reading.invalid) markers.push_back(static_cast<float>(value));
  const std::size_t told = markers.size();
  if (reading.has_usual_markers)
    markers.insert(markers.end(), kUsualMarkers.begin(), kUsualMarkers.end());
  std::vector<std::size_t> counts(markers.size());
  for (float& value : values) {
    const auto marker = std::find(markers.begin(), markers.end(), value);
    if (marker == markers.end()) continue;
    ++counts[static_cast<std::size_t>(marker - markers.begin())];
    value = 0;
  }
  for (std::size_t k = told; k < markers.size(); ++k) {
    if (counts[k] == 0) continue;
    remarks.push_back(
        {false, std::to_string(counts[k]) + " pixels hold " + number_text(markers[k]) +
                    ", which is taken for \"not measured\"; `invalid` none takes it for a depth"});
  }
}

double ray_length(const Intrinsics& k, double u, double v) {
  const double x = (u - k.cx) / k.fx, y = (v - k.cy) / k.fy;
  return std::sqrt(1 + x * x + y * y);
}

void along_optical_axis(DepthImage& image, const Intrinsics& intrinsics) {
  for (std::uint32_t v = 0; v < image.height; ++v) {
    for (std::uint32_t u = 0; u < image.width; ++u) {
      float& depth = image.depth[image.index(u, v)];
      depth = static_cast<float>(depth / ray_length(intrinsics, u, v));
    }
  }
}

}  // namespace

DepthDecoding decoding_from_text(const std::string& text) {
  DepthDecoding decoding;
  std::size_t at = 0;
  while (at <= text.size()) {
    const std::size_t end = std::min(text.find(',', at), text.size());
    const std::string word = text.substr(at, end - at);
    if (word == "swapped") {
      decoding.swapped = true;
    } else if (word == "rotated") {
      decoding.rotated = true;
    } else if (word == "disparity") {
      decoding.disparity = true;
    } else {
      throw Error(ErrorKind::invalid_argument,
                  "'" + file::shown(word) + "' is not swapped, rotated or disparity", "`decode`");
    }
    at = end + 1;
  }
  return decoding;
}

DepthImage depth_in_metres_of(const RawDepth& raw, const Intrinsics& intrinsics,
                              const DepthReading& reading, const std::string& name,
                              Remarks& remarks) {
  append(remarks, raw.remarks);
  if (!reading.units_per_metre) append(remarks, raw.unit_remarks);
  std::vector<float> values = raw.values;
  const bool look_coded = decode(values, raw, reading, name, remarks);
  remove_markers(values, reading, remarks);
  // A disparity has become metres.
  const double usual = reading.decoding.disparity ? 1 : raw.usual_units_per_metre();
  const double units_per_metre = reading.units_per_metre.value_or(usual);
  if (reading.looks_for_mistakes && !look_coded)
    append(remarks, marker_suspicions(values, reading.farthest * units_per_metre));
  DepthImage image{raw.width, raw.height, std::move(values)};
  for (float& depth : image.depth) depth = depth_in_metres(depth, units_per_metre);
  if (reading.along_ray) along_optical_axis(image, intrinsics);
  if (reading.nearest > 0 || reading.farthest < HUGE_VAL) {
    for (float& depth : image.depth)
      if (!(depth >= reading.nearest && depth <= reading.farthest)) depth = 0;
  }
  return image;
}

}  // namespace vpm
