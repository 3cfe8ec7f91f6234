// Samples a camera's surface, and adds samples of a cell's blocks, at many places at once by
// vectors, with the bits of DepthSurface and SamplesInTurn. Host only.
#pragma once

#include <algorithm>
#include <iterator>
#include <span>
#include <type_traits>

#include "libvpm/measure/cell_measure.h"
#include "libvpm/model/tool_model.h"
#include "libvpm/scene/depth/depth_surface.h"

namespace vpm {

// Holds a place and its surface sample, surface frame.
struct PlaceSample {
  Vec3 x;
  SurfaceSample on_surface;
};

struct SurfaceOfSample {
  std::uint32_t sample = 0;  // index
  PlaceSample at;
};

void sample_four(const DepthSurface& surface, const Vec3 (&places)[4],
                 SurfaceSample (&on_surface_at)[4]);

// Samples the surface for those tool samples that it reaches: whose distance is less than their
// radius. Writes them in order to `on_surface_at` and returns their number.
std::uint32_t sample_surface(const DepthSurface& surface, const Pose& to_surface,
                             std::span<const CellSample> samples, SurfaceOfSample* on_surface_at);

// Writes DepthSurface::closest_normal of each sampled place.
void closest_normals(const DepthSurface& surface, std::span<const PlaceSample> places,
                     Vec3* normals);

// Returns the bits of clipped_in_turn().
ClippedMoments clipped_moments(const ClipPlane& plane, const CellSample* samples,
                               std::uint32_t count);

// True for a surface that vectors sample at several places at once.
template <class Surface>
concept SamplesFour = requires(const Surface& surface, const Vec3 (&places)[4],
                               SurfaceSample (&on_surface_at)[4]) {
  sample_four(surface, places, on_surface_at);
};

// Samples a surface at four places by vectors where it can be, others one after another.
struct SampleTogether : SampleInTurn {
  template <class Surface, class Take>
  bool operator()(const Surface& surface, const Vec3 (&places)[4], const Take& take) const {
    if constexpr (SamplesFour<Surface>) {
      SurfaceSample on_surface_at[4];
      sample_four(surface, places, on_surface_at);
      return std::all_of(std::begin(on_surface_at), std::end(on_surface_at), take);
    } else {
      return SampleInTurn{}(surface, places, take);
    }
  }
};

// Adds samples one by one, for surfaces that vectors cannot sample.
struct SamplesOneByOne : SamplesInTurn {
  static constexpr auto* clipped = clipped_moments;
};

// Adds the samples of one cell before a camera, by vectors.
class SamplesTogether {
 public:
  static constexpr auto* clipped = clipped_moments;

  template <class Measure>
  void add(const Measure& measure, const CellSample* samples, std::uint32_t count,
           const DepthSurface& surface, CellResult& result) {
    neighbors_ = kNone;  // a new block begins
    for (std::uint32_t first = 0; first < count; first += kAtOnce) {
      const std::uint32_t some = count - first < kAtOnce ? count - first : kAtOnce;
      const std::uint32_t found =
          sample_surface(surface, measure.to_surface(), {samples + first, some}, on_surface_at_);
      for (std::uint32_t k = 0; k < found; ++k)
        add_one(measure, samples, first + on_surface_at_[k].sample, on_surface_at_[k].at, result);
    }
  }
  // Finds the directions that were put off, together, and adds their samples.
  template <class Measure>
  void flush(const Measure& measure, CellResult& result) {
    if (direction_count_ == 0) return;
    Vec3 normals[kAtOnce];
    closest_normals(measure.surface(), {searched_, direction_count_}, normals);
    static_assert(!HasOtherWalls<DepthSurface>);  // push() divides none
    for (std::uint32_t k = 0; k < pushed_count_; ++k) {
      measure.add_pushed(piece_of(*pushed_[k].sample), normals[pushed_[k].direction], result.sum);
    }
    direction_count_ = pushed_count_ = 0;
  }

 private:
  static constexpr std::uint32_t kAtOnce = 16;

  template <class Measure>
  void add_one(const Measure& measure, const CellSample* samples, std::uint32_t k,
               const PlaceSample& at, CellResult& result) {
    const ToolPiece piece = piece_of(samples[k]);
    const typename Measure::PieceSample sampled = measure.sample_of(piece, at.x, at.on_surface);
    if (!measure.note(piece, sampled, result)) return;
    if (Measure::way_out(piece, sampled, true) != WayOut::shared) {
      measure.push(piece, sampled, {}, measure.surface(), result.sum);
      return;
    }
    if (neighbors_ != neighbors_of(k)) {
      neighbors_ = neighbors_of(k);
      if (direction_count_ == kAtOnce) flush(measure, result);
      searched_[direction_count_++] = at;
    }
    pushed_[pushed_count_++] = {samples + k, direction_count_ - 1};
  }

  static constexpr std::uint32_t kNone = UINT32_MAX;
  struct Pushed {
    const CellSample* sample;
    std::uint32_t direction;  // index into searched_
  };

  SurfaceOfSample on_surface_at_[kAtOnce];
  PlaceSample searched_[kAtOnce];
  Pushed pushed_[kAtOnce * kNeighborSamples];
  std::uint32_t direction_count_ = 0, pushed_count_ = 0;
  std::uint32_t neighbors_ = kNone;  // run of samples that the last direction is for
};

template <class Surface>
using SamplesOnHost = std::conditional_t<SamplesFour<Surface>, SamplesTogether, SamplesOneByOne>;

}  // namespace vpm
