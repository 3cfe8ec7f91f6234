#include "libvpm/import/scan_facts.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "libvpm/core/box.h"

namespace vpm {
namespace {

template <class... Values>
std::string text_of(const char* format, Values... values) {
  char text[320];
  std::snprintf(text, sizeof text, format, values...);
  return text;
}

std::string size_text(const Camera& camera) {
  return std::to_string(camera.width) + " x " + std::to_string(camera.height) + " pixels";
}

// Returns the text for a principal point that lies in the middle of an image of another size: it
// names that size, and the intrinsics scaled to this image.
std::string other_size_text(const Camera& camera) {
  constexpr double kSameShape = 0.02;
  const Intrinsics& k = camera.intrinsics;
  const double across = (2 * k.cx + 1) / camera.width, down = (2 * k.cy + 1) / camera.height;
  if (!(across > 0 && down > 0) || std::abs(across / down - 1) > kSameShape)
    return "; are these the intrinsics of this image?";
  const Intrinsics scaled{k.fx / across, k.fy / across, (k.cx + 0.5) / across - 0.5,
                          (k.cy + 0.5) / across - 0.5};
  return text_of("; if that was scaled from %.0f x %.0f, ", 2 * k.cx + 1, 2 * k.cy + 1) +
         "give `intrinsics` " + intrinsics_text(scaled);
}

// True if the numbers are parts of the image's size, as some programs write them.
bool are_normalised(const Intrinsics& k) {
  constexpr double kLargestFocal = 5, kLargestCentre = 1;
  return k.fx < kLargestFocal && k.fy < kLargestFocal && k.cx >= 0 && k.cx <= kLargestCentre &&
         k.cy >= 0 && k.cy <= kLargestCentre;
}

}  // namespace

std::string intrinsics_text(const Intrinsics& k) {
  return text_of("%.9g,%.9g,%.9g,%.9g", k.fx, k.fy, k.cx, k.cy);
}

std::optional<DepthRange> range_of(const DepthImage& image) {
  std::vector<float> measured;
  std::copy_if(image.depth.begin(), image.depth.end(), std::back_inserter(measured), is_measured);
  if (measured.empty()) return std::nullopt;
  const auto middle = measured.begin() + static_cast<std::ptrdiff_t>(measured.size() / 2);
  std::nth_element(measured.begin(), middle, measured.end());
  return DepthRange{*std::min_element(measured.begin(), middle + 1), *middle,
                    *std::max_element(middle, measured.end())};
}

ScanFacts facts_of(const Cloud& cloud, std::size_t invalid, std::size_t all) {
  ScanFacts facts;
  if (cloud.sensor) facts.depth = range_of(cloud.sensor->depth);
  facts.measured = all == 0 ? 0 : 1 - static_cast<double>(invalid) / static_cast<double>(all);
  if (cloud.size() == 0) return facts;
  Box box;
  for (const Vec3f& p : cloud.positions) box.add(widen(p));
  facts.low = cloud.origin + box.low;
  facts.high = cloud.origin + box.high;
  return facts;
}

std::string metres_text(double length) {
  return text_of("%.3g m", length);
}

Remarks improbable_depths(const ScanFacts& facts, const std::optional<double>& units_per_metre) {
  constexpr double kNearest = 0.05, kFarthest = 50, kFewest = 0.05;
  Remarks remarks;
  const bool is_far = facts.depth && facts.depth->median > kFarthest;
  if (is_far && units_per_metre && *units_per_metre < 1) {
    remarks.push_back({true, text_of("half of its depths are above %.3g m: `depth_scale` is the "
                                     "number of units per metre; if a unit is %.9g m, give %.9g",
                                     facts.depth->median, *units_per_metre, 1 / *units_per_metre)});
  } else if (facts.depth && (facts.depth->median < kNearest || facts.depth->median > kFarthest)) {
    remarks.push_back(
        {true, text_of("half of its depths are %s %.3g m, which is improbable: is its unit another "
                       "one? `depth_scale` tells it, in units per metre",
                       facts.depth->median < kNearest ? "below" : "above", facts.depth->median)});
  }
  if (facts.depth && facts.measured < kFewest)
    remarks.push_back(
        {true, text_of("only %.2g %% of its pixels hold a measurement", 100 * facts.measured)});
  return remarks;
}

Remarks improbable_intrinsics(const Camera& camera) {
  constexpr double kShortest = 0.2, kLongest = 5;  // times the image's width
  constexpr double kOffCentre = 0.2;               // times the image's width or height
  constexpr double kMostUnequal = 1.3;
  const Intrinsics& k = camera.intrinsics;
  const double width = camera.width, height = camera.height;
  if (are_normalised(k) && camera.width > 1) {
    const Intrinsics pixels{k.fx * width, k.fy * height, k.cx * width - 0.5, k.cy * height - 0.5};
    return {{true, "the intrinsics " + intrinsics_text(k) +
                       " are less than a pixel or a few; if they are parts of the image's " +
                       "size, give `intrinsics` " + intrinsics_text(pixels)}};
  }
  Remarks remarks;
  const bool is_outside = !(k.cx >= 0 && k.cy >= 0 && k.cx < width && k.cy < height);
  if (is_outside || std::abs(k.cx - (width - 1) / 2) > kOffCentre * width ||
      std::abs(k.cy - (height - 1) / 2) > kOffCentre * height) {
    remarks.push_back({true, "the principal point of " + intrinsics_text(k) + " lies " +
                                 (is_outside ? "outside" : "far from the middle") +
                                 " of the image of " + size_text(camera) +
                                 other_size_text(camera)});
  }
  if (std::max(k.fx, k.fy) > kMostUnequal * std::min(k.fx, k.fy)) {
    remarks.push_back(
        {true, "the focal lengths of " + intrinsics_text(k) +
                   " differ more than those of cameras; is their order fx,fy,cx,cy?"});
  }
  if (std::min(k.fx, k.fy) < kShortest * width || std::max(k.fx, k.fy) > kLongest * width) {
    remarks.push_back({true, "the focal lengths of " + intrinsics_text(k) +
                                 " are improbable for an image of " + size_text(camera) +
                                 "; are these the intrinsics of this image's size?"});
  }
  return remarks;
}

std::string words_of(const ScanFacts& facts) {
  std::string words;
  if (facts.depth)
    words = text_of("depth %.4g to %.4g m, median %.4g m; ", facts.depth->nearest,
                    facts.depth->farthest, facts.depth->median);
  const Vec3 size = facts.high - facts.low;
  return words + text_of(
                     "%.4g %% measured; the scene is %.4g x %.4g x %.4g m, from (%.4g, %.4g, %.4g) "
                     "to (%.4g, %.4g, %.4g)",
                     100 * facts.measured, size.x, size.y, size.z, facts.low.x, facts.low.y,
                     facts.low.z, facts.high.x, facts.high.y, facts.high.z);
}

}  // namespace vpm
