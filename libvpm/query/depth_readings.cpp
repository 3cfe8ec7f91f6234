#include "libvpm/query/depth_readings.h"

#include <algorithm>

#include "libvpm/core/vector_clones.h"
#include "libvpm/query/depth_lanes.h"

namespace vpm {
namespace {

VPM_VECTOR_CLONES void read_lanes(const DepthSurface& surface, const Vec3* places,
                                  Reading* readings) {
  const LaneReading reading =
      DepthLanes(surface).read(lanes(places[0], places[1], places[2], places[3]));
  for (int k = 0; k < kVec3Lanes; ++k) readings[k] = reading.of(k, surface.width);
}

VPM_VECTOR_CLONES std::uint32_t read_sample_lanes(const DepthSurface& surface,
                                                  const Pose& to_surface, const CellSample* samples,
                                                  std::uint32_t count, SampleReading* readings) {
  const DepthLanes depths(surface);
  std::uint32_t found = 0;
  for (std::uint32_t first = 0; first < count; first += kVec3Lanes) {
    const auto sample = [&](std::uint32_t k) -> const CellSample& {
      return samples[std::min(first + k, count - 1)];
    };
    const CellSample &a = sample(0), &b = sample(1), &c = sample(2), &d = sample(3);
    const LaneVec3 x = to_surface * lanes(a.center, b.center, c.center, d.center);
    const Doubles radius = widen(HalfFloats{a.radius, b.radius, c.radius, d.radius});
    const LaneReading reading = depths.read(x);
    const LaneMask reached = reading.known & (reading.distance < radius);
    if (!any(reached)) continue;
    for (int k = 0; k < kVec3Lanes && first + k < count; ++k) {
      if (reached[k] != 0) readings[found++] = {first + k, {x.of(k), reading.of(k, surface.width)}};
    }
  }
  return found;
}

VPM_VECTOR_CLONES void closest_normal_lanes(const DepthSurface& surface, const PlaceReading* places,
                                            std::size_t count, Vec3* normals) {
  for (std::size_t first = 0; first < count; first += kVec3Lanes) {
    const auto place = [&](std::size_t k) -> const PlaceReading& {
      return places[std::min(first + k, count - 1)];
    };
    const PlaceReading &a = place(0), &b = place(1), &c = place(2), &d = place(3);
    const Reading &ra = a.reading, &rb = b.reading, &rc = c.reading, &rd = d.reading;
    const auto column = [&](const Reading& reading) {
      return static_cast<std::int32_t>(reading.point) % surface.width;
    };
    const auto row = [&](const Reading& reading) {
      return static_cast<std::int32_t>(reading.point) / surface.width;
    };
    const LaneReading reading{LaneMask{} - 1,
                              Doubles{ra.distance, rb.distance, rc.distance, rd.distance},
                              lanes(ra.normal, rb.normal, rc.normal, rd.normal),
                              lanes(ra.foot, rb.foot, rc.foot, rd.foot),
                              HalfInts{column(ra), column(rb), column(rc), column(rd)},
                              HalfInts{row(ra), row(rb), row(rc), row(rd)}};
    const LaneVec3 normal = DepthLanes(surface).closest_normal(lanes(a.x, b.x, c.x, d.x), reading);
    for (int k = 0; k < kVec3Lanes && first + k < count; ++k) normals[first + k] = normal.of(k);
  }
}

}  // namespace

void read_four(const DepthSurface& surface, const Vec3 (&places)[4], Reading (&readings)[4]) {
  static_assert(kVec3Lanes == 4);
  read_lanes(surface, places, readings);
}

std::uint32_t read_samples(const DepthSurface& surface, const Pose& to_surface,
                           std::span<const CellSample> samples, SampleReading* readings) {
  return read_sample_lanes(surface, to_surface, samples.data(),
                           static_cast<std::uint32_t>(samples.size()), readings);
}

void closest_normals(const DepthSurface& surface, std::span<const PlaceReading> places,
                     Vec3* normals) {
  closest_normal_lanes(surface, places.data(), places.size(), normals);
}

}  // namespace vpm
