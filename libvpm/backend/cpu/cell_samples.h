// Samples the surface that a camera sees, or several do, and adds samples of a cell's blocks, at
// many places at once by vectors, with the bits of these surfaces and SamplesInTurn. Host only.
#pragma once

#include <algorithm>
#include <iterator>
#include <span>
#include <type_traits>

#include "libvpm/backend/cpu/spatial_level.h"
#include "libvpm/measure/cell_measure.h"
#include "libvpm/measure/contact_patch.h"
#include "libvpm/model/tool_model.h"
#include "libvpm/scene/depth/depth_surface.h"
#include "libvpm/scene/rig/rig_surface.h"

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
void sample_four(const RigSurface& surface, const Vec3 (&places)[4],
                 SurfaceSample (&on_surface_at)[4]);
void sample_four(const RigSurface::View& surface, const Vec3 (&places)[4],
                 SurfaceSample (&on_surface_at)[4]);

// Samples the surface for those tool samples that reach it, and those where none is known. Writes
// them in order to `on_surface_at` and returns their number. Of samples wholly behind the surface,
// by less than `deepest`, m, it may tell only that: any such distance, and neither normal nor foot.
std::uint32_t sample_surface(const DepthSurface& surface, const Pose& to_surface,
                             std::span<const CellSample> samples, const SampleFaces& faces,
                             double deepest, SurfaceOfSample* on_surface_at);
std::uint32_t sample_surface(const RigSurface::View& surface, const Pose& to_surface,
                             std::span<const CellSample> samples, const SampleFaces& faces,
                             double deepest, SurfaceOfSample* on_surface_at);

// Writes closest_normal() of each sampled place.
void closest_normals(const DepthSurface& surface, std::span<const PlaceSample> places,
                     Vec3* normals);
void closest_normals(const RigSurface& surface, std::span<const PlaceSample> places, Vec3* normals);

// Returns the bits of clipped_in_turn().
ClippedMoments clipped_moments(const ClipPlane& plane, const CellSample* samples,
                               std::uint32_t count, const SampleFaces& faces);

// Adds samples, kAtOnce at most, to what a plane leaves behind of their cell. Returns a bit for
// each of which a part is behind.
std::uint32_t add_section(const ClipPlane& plane, std::span<const CellSample> samples,
                          const SampleFaces& faces, CellSection& cell);

// Adds those parts of the tool that are free and were not seen at their centroids.
void add_unseen(const DepthSurface& surface, const Pose& to_surface, const FreeParts& parts,
                UnseenSum& unseen);
void add_unseen(const RigSurface& surface, const Pose& to_surface, const FreeParts& parts,
                UnseenSum& unseen);

// True for a surface that vectors sample at several places at once.
template <class Surface>
concept SamplesFour = requires(const Surface& surface, const Vec3 (&places)[4],
                               SurfaceSample (&on_surface_at)[4]) {
  sample_four(surface, places, on_surface_at);
};

// True for a surface, or a part of one, that searches at four places at once, from a point near
// them on.
template <class Surface>
concept SearchesFour = requires(const Surface& surface, const Vec3 (&places)[4],
                                SurfaceSample (&on_surface_at)[4]) {
  surface.sample_four(places, kNoPoint, on_surface_at);
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

// Most places that are sampled, or ways out that are searched for, together.
inline constexpr std::uint32_t kAtOnce = 16;

// Samples a surface at places, kAtOnce at most, by vectors where it can be.
template <class Surface>
void sample_places(const Surface& surface, std::span<const Vec3> places, PlaceSample* at) {
  if constexpr (SamplesFour<Surface> || SearchesFour<Surface>) {
    const std::size_t last = places.size() - 1;
    for (std::size_t k = 0; k < places.size(); k += 4) {
      const Vec3 four[] = {places[k], places[std::min(k + 1, last)], places[std::min(k + 2, last)],
                           places[std::min(k + 3, last)]};
      SurfaceSample on_surface_at[4];
      if constexpr (SamplesFour<Surface>)
        sample_four(surface, four, on_surface_at);
      else
        surface.sample_four(four, k > 0 ? at[k - 1].on_surface.point : kNoPoint, on_surface_at);
      for (std::size_t lane = 0; lane < 4 && k + lane <= last; ++lane)
        at[k + lane] = {four[lane], on_surface_at[lane]};
    }
  } else {
    for (const Vec3& x : places) *at++ = {x, surface.sample(x)};
  }
}
// Writes closest_normal() of each sampled place, by vectors where it can be.
template <class Surface>
void find_normals(const Surface& surface, std::span<const PlaceSample> places, Vec3* normals) {
  if constexpr (SamplesFour<Surface>) {
    closest_normals(surface, places, normals);
  } else {
    for (const auto& [x, on_surface] : places) *normals++ = surface.closest_normal(x, on_surface);
  }
}

// Measures pieces that share no direction, several together. Surface is that of `measure`.
template <class Surface>
class PiecesTogether {
 public:
  using Measure = CellMeasure<Surface>;
  using PieceSample = typename Measure::PieceSample;

  // Adds a piece; push() must have emptied what is full.
  void add(const ToolPiece& piece) { pieces_[count_++] = piece; }
  bool is_full() const { return count_ == kAtOnce; }

  // Samples the pieces that were added, in order, and pushes those for which
  // takes(piece, k, sampled) is true. Calls take(k, sum) for these. Empties the list.
  template <class Takes, class Take>
  void push(const Measure& measure, const Takes& takes, const Take& take) {
    if (count_ == 0) return;
    Vec3 places[kAtOnce], normals[kAtOnce];
    for (std::uint32_t k = 0; k < count_; ++k) places[k] = measure.to_surface() * pieces_[k].at;
    PlaceSample at[kAtOnce], searched[kAtOnce];
    sample_places(measure.surface(), {places, count_}, at);
    std::uint32_t taken[kAtOnce], found = 0;
    for (std::uint32_t k = 0; k < count_; ++k) {
      if (!takes(pieces_[k], k, measure.sample_of(pieces_[k], at[k].x, at[k].on_surface))) continue;
      taken[found] = k;
      searched[found++] = at[k];
    }
    find_normals(measure.surface(), {searched, found}, normals);
    for (std::uint32_t f = 0; f < found; ++f) {
      const ToolPiece& piece = pieces_[taken[f]];
      ToolSum sum;
      measure.push(piece, measure.sample_of(piece, searched[f].x, searched[f].on_surface),
                   normals[f], measure.surface(), sum);
      take(taken[f], sum);
    }
    count_ = 0;
  }

 private:
  ToolPiece pieces_[kAtOnce];
  std::uint32_t count_ = 0;
};

// Does what CellMeasure::add_far() does, several pieces together.
template <class Surface, class Supports>
void add_far_together(const CellMeasure<Surface>& measure, std::span<const PieceIndex> pieces,
                      const Supports& supports, ToolSum& sum, UnseenSum& unseen) {
  PiecesTogether<Surface> together;
  const auto push = [&] {
    together.push(
        measure,
        [&](const ToolPiece& piece, std::uint32_t, const auto& far) {
          if (!supports(far.x, far.on_surface.foot)) return false;
          unseen.remove_occluded(piece.weight);
          return true;
        },
        [&](std::uint32_t, const ToolSum& part) { sum.add(part); });
  };
  for (const PieceIndex& far : pieces) {
    together.add(measure.piece_of_far(far));
    if (together.is_full()) push();
  }
  push();
}

// Adds samples one by one, for surfaces that vectors cannot sample. Those that search do so for
// four samples at once.
struct SamplesOneByOne : SamplesInTurn {
  static constexpr auto* clipped = clipped_moments;

  template <class Measure, class Near>
  void add(const Measure& measure, const SampleRange& range, const Near& near, PieceIndex* far,
           CellResult& result) const {
    if constexpr (SearchesFour<Near>) {
      typename Measure::SharedDirection shared;
      for (std::uint32_t first = range.begin; first < range.end; first += 4) {
        Vec3 places[4];
        for (std::uint32_t k = 0; k < 4; ++k) {
          const std::uint32_t sample = std::min(first + k, range.end - 1);
          places[k] = measure.to_surface() * measure.piece_of_sample(sample).at;
        }
        SurfaceSample on_surface_at[4];
        near.sample_four(places, result.point, on_surface_at);
        for (std::uint32_t k = 0; k < 4 && first + k < range.end; ++k)
          measure.add_sample(first + k, first + k - range.begin, places[k], on_surface_at[k],
                             shared, far, result, near);
      }
    } else {
      SamplesInTurn::add(measure, range, near, far, result);
    }
  }
};

// Adds the samples of one cell before cameras, by vectors.
class SamplesTogether {
 public:
  static constexpr auto* clipped = clipped_moments;

  template <class Measure, class Near>
  void add(const Measure& measure, const SampleRange& range, const Near& surface, PieceIndex* far,
           CellResult& result) {
    if (have_faces(range.all + range.begin, range.end - range.begin))
      add_block_with_faces(measure, range, surface, far, result);
    else
      add_block<false>(measure, range, surface, far, result);
  }
  // Finds the directions that were put off, together, and adds their samples.
  template <class Measure>
  void flush(const Measure& measure, CellResult& result) {
    if (direction_count_ == 0) return;
    Vec3 normals[kAtOnce];
    closest_normals(measure.surface(), {searched_, direction_count_}, normals);
    static_assert(!HasOtherWalls<DepthSurface> &&
                  !HasOtherWalls<RigSurface>);  // push() divides none
    for (std::uint32_t k = 0; k < pushed_count_; ++k) {
      measure.add_pushed(measure.piece_of_sample(pushed_[k].sample), normals[pushed_[k].direction],
                         result.sum);
    }
    direction_count_ = pushed_count_ = 0;
  }

  template <class Measure, class Supports>
  static void add_far(const Measure& measure, std::span<const PieceIndex> pieces,
                      const Supports& supports, ToolSum& sum, UnseenSum& unseen) {
    add_far_together(measure, pieces, supports, sum, unseen);
  }

 private:
  template <bool kHaveFaces, class Measure, class Near>
  void add_block(const Measure& measure, const SampleRange& range, const Near& surface,
                 PieceIndex* far, CellResult& result) {
    neighbors_ = kNone;
    for (std::uint32_t first = range.begin; first < range.end; first += kAtOnce) {
      const std::uint32_t some = std::min(range.end - first, kAtOnce);
      const std::uint32_t found =
          sample_surface(surface, measure.to_surface(), {range.all + first, some}, measure.faces(),
                         measure.tool_radius().supported_beyond, on_surface_at_);
      for (std::uint32_t k = 0; k < found; ++k)
        add_one<kHaveFaces>(measure, range, first + on_surface_at_[k].sample, on_surface_at_[k].at,
                            far, result);
    }
  }
  // Stands apart, so that blocks of balls have its instructions in no one's way.
  template <class Measure, class Near>
  [[gnu::noinline]] void add_block_with_faces(const Measure& measure, const SampleRange& range,
                                              const Near& surface, PieceIndex* far,
                                              CellResult& result) {
    add_block<true>(measure, range, surface, far, result);
  }
  template <bool kHaveFaces, class Measure>
  void add_one(const Measure& measure, const SampleRange& range, std::uint32_t k,
               const PlaceSample& at, PieceIndex* far, CellResult& result) {
    // A block of balls asks none for its shape again.
    const ToolPiece piece = kHaveFaces ? measure.piece_of_sample(k) : piece_of_ball(range.all[k]);
    const typename Measure::PieceSample sampled = measure.sample_of(piece, at.x, at.on_surface);
    if (!measure.note(piece, sampled, PieceIndex::sample(k), far, result)) return;
    if (Measure::way_out(sampled, true) != WayOut::shared) {
      measure.push(piece, sampled, {}, measure.surface(), result.sum);
      return;
    }
    if (neighbors_ != neighbors_of(k - range.begin)) {
      neighbors_ = neighbors_of(k - range.begin);
      if (direction_count_ == kAtOnce) flush(measure, result);
      searched_[direction_count_++] = at;
    }
    pushed_[pushed_count_++] = {k, direction_count_ - 1};
  }

  static constexpr std::uint32_t kNone = UINT32_MAX;
  struct Pushed {
    std::uint32_t sample;     // index
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
