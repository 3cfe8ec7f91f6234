#include "tools/normals/scan_view.h"

#include <algorithm>
#include <array>
#include <cstdio>

#include "libvpm/view/page.h"

namespace vpm::tools {
namespace {

// Why a pixel is not in the cloud; the order of the colours in the page.
enum Reason : std::uint8_t { has_normal, not_measured, out_of_range, no_normal };
constexpr std::array<const char*, 4> kReasons{"with a normal", "not measured", "depth out of range",
                                              "measured, too few neighbours for a normal"};
constexpr const char* kNoNormalColor = "#d55e00";
constexpr std::size_t kBins = 64, kMostMarks = 30'000;
// The share of depths, at either end, that the histogram leaves out.
constexpr double kTail = 0.002;

struct Pixels {
  std::vector<Vec3f> normals;  // camera axes
  std::vector<std::uint8_t> reasons;
  std::array<std::size_t, 4> counts{};
};

Pixels pixels_of(const Cloud& cloud) {
  const DepthImage& image = cloud.sensor->depth;
  const Rotation to_camera = transpose(cloud.sensor->camera.to_world.rotation);
  Pixels pixels;
  pixels.normals.resize(image.depth.size());
  for (std::size_t k = 0; k < cloud.size(); ++k)
    pixels.normals[cloud.pixels[k]] = narrow(to_camera * widen(cloud.normals[k]));
  for (std::size_t k = 0; k < image.depth.size(); ++k) {
    const float depth = image.depth[k];
    const Reason reason = !is_measured(depth)                          ? not_measured
                          : usable_depth(depth) == 0                   ? out_of_range
                          : squared_norm(widen(pixels.normals[k])) > 0 ? has_normal
                                                                       : no_normal;
    pixels.reasons.push_back(reason);
    ++pixels.counts[reason];
  }
  return pixels;
}

void add_depths(view::Page& page, const DepthImage& image) {
  std::vector<float> depths;
  for (const float d : image.depth)
    if (is_measured(d)) depths.push_back(d);
  std::ranges::sort(depths);
  const auto last = static_cast<double>(depths.size() - 1);
  const double low = depths[static_cast<std::size_t>(kTail * last)];
  const double high =
      std::max<double>(depths[static_cast<std::size_t>((1 - kTail) * last)], low * (1 + 1e-6));
  std::vector<std::uint32_t> counts(kBins, 0);
  for (const double d : depths) {
    if (d < low || d > high) continue;
    const auto bin = static_cast<std::size_t>((d - low) / (high - low) * kBins);
    ++counts[std::min(bin, kBins - 1)];
  }
  page.add_fact("median depth", view::with_unit(depths[depths.size() / 2], "m"));
  page.add_chart({{"type", "histogram"},
                  {"title", "Depths"},
                  {"x", "depth"},
                  {"unit", "m"},
                  {"y", "pixels"},
                  {"low", low},
                  {"high", high},
                  {"counts", view::packed(std::span<const std::uint32_t>(counts))}});
}

void add_marks(view::Page& page, const CloudSensor& sensor, const Pixels& pixels) {
  const std::size_t every = pixels.counts[no_normal] / kMostMarks + 1;
  std::vector<Vec3> places;
  std::size_t found = 0;
  for (std::size_t k = 0; k < pixels.reasons.size(); ++k) {
    if (pixels.reasons[k] != no_normal || found++ % every != 0) continue;
    const auto u = static_cast<double>(k % sensor.depth.width);
    const auto v = static_cast<double>(k / sensor.depth.width);
    places.push_back(sensor.camera.to_world *
                     unproject(sensor.camera.intrinsics, u, v, sensor.depth.depth[k]));
  }
  const std::vector<std::uint32_t> until(places.size(), 1);  // shown at the only step
  if (!places.empty()) page.add_dust("measured, no normal", kNoNormalColor, places, until);
}

void add_image(view::Page& page, const Cloud& cloud) {
  const CloudSensor& sensor = *cloud.sensor;
  const Pixels pixels = pixels_of(cloud);
  const view::ImageView image{&sensor.depth, sensor.camera, pixels.normals, pixels.reasons};
  page.set_up(sensor.camera.to_world.rotation * Vec3{0, -1, 0});
  page.add_image("surface by normal", {&image, 1}, {}, true);
  add_marks(page, sensor, pixels);
  view::Json reasons = view::Json::array();
  for (std::size_t k = 0; k < kReasons.size(); ++k)
    reasons.push_back({kReasons[k], pixels.counts[k]});
  page.add_chart({{"type", "picture"},
                  {"title", "Depth image: near bright, far dark"},
                  {"layer", 0},
                  {"reasons", std::move(reasons)}});
  add_depths(page, sensor.depth);
  const Intrinsics& k = sensor.camera.intrinsics;
  page.add_fact("image", std::to_string(sensor.depth.width) + " × " +
                             std::to_string(sensor.depth.height) + " pixels");
  char text[128];
  std::snprintf(text, sizeof text, "%.6g, %.6g, %.6g, %.6g pixels", k.fx, k.fy, k.cx, k.cy);
  page.add_fact("fx, fy, cx, cy", text);
}

}  // namespace

void write_scan_view(const std::string& path, const std::string& input,
                     const ImportedCloud& imported, const NormalOptions& options) {
  const Cloud& cloud = imported.cloud;
  view::Page page("vpm-normals", view::shown_name(input));
  page.set_origin(cloud.origin);
  page.add_fact("points with normals", std::to_string(cloud.size()));
  page.add_fact("not measured", std::to_string(imported.invalid));
  if (imported.removed > 0) page.add_fact("removed with solids", std::to_string(imported.removed));
  page.add_fact("measured, no normal", std::to_string(imported.without_normal));
  if (imported.normals_estimated)
    page.add_fact("normals", to_text(options.method) + ", window of " +
                                 std::to_string(options.window) + " pixels");
  else
    page.add_fact("normals", "of the file");
  if (cloud.sensor) {
    add_image(page, cloud);
    page.set_views({"overview", "camera", "side"});
  } else {
    page.add_points("points by normal", cloud, true);
    page.set_views({"overview", "side"});
  }
  page.write(path);
}

}  // namespace vpm::tools
