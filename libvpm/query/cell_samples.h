// The samples of a cell's blocks, many at once: what SamplesInTurn adds, by vectors. On the host.
#pragma once

#include <algorithm>
#include <cmath>
#include <iterator>
#include <span>
#include <type_traits>

#include "libvpm/query/cell.h"
#include "libvpm/query/contact_slopes.h"
#include "libvpm/query/depth_readings.h"

namespace vpm {

// SamplesInTurn::crossed.
CrossedSums crossed_sums(const CrossingPlane& plane, std::span<const CellSample> samples);
// The same, and the slopes of the samples that are cut.
CrossedSums crossed_sums(const CrossingPlane& plane, std::span<const CellSample> samples,
                         CrossedSlopes& slopes);

// Reads the surface of a camera at four places by vectors, others one after the other.
struct ReadTogether {
  template <class Surface, class Take>
  bool operator()(const Surface& surface, const Vec3 (&places)[4], const Take& take) const {
    if constexpr (std::is_same_v<Surface, DepthSurface>) {
      Reading readings[4];
      read_four(surface, places, readings);
      return std::all_of(std::begin(readings), std::end(readings), take);
    } else {
      return ReadInTurn{}(surface, places, take);
    }
  }
};

// Disks are searched for one place after another.
struct SamplesAmongDisks : SamplesInTurn {
  static CrossedSums crossed(const CrossingPlane& plane, const CellSample* samples,
                             std::uint32_t count) {
    return crossed_sums(plane, {samples, count});
  }
};

struct CrossedTogether : WithoutNotes {
  static CrossedSums crossed(const CrossingPlane& plane, const CellSample* samples,
                             std::uint32_t count) {
    return crossed_sums(plane, {samples, count});
  }
};

// Notes how what samples and blocks add changes as the tool moves.
class SlopeNotes {
 public:
  SlopeNotes(ToolReach reach, ContactSlopes& slopes) : reach_(reach), slopes_(slopes) {}

  void begin_share() { noted_ = {}; }
  void add_whole_block(const BlockMass& mass, const ToolSum& sum) { add_rest(mass.centroid, sum); }
  CrossedSums crossed(const CrossingPlane& plane, const CellSample* samples, std::uint32_t count) {
    CrossedSlopes slopes;
    const CrossedSums sums = crossed_sums(plane, {samples, count}, slopes);
    slopes_.add_crossed(plane.normal, sums, slopes, reach_.inverse);
    noted_ += sums.weight * plane.normal;
    return sums;
  }
  void add_cut(const CellSample& sample, double weight, double distance, Vec3 normal) {
    const Vec3 at = widen(sample.center);
    const double radius = sample.radius;
    CrossedSlopes slopes;
    if (std::abs(distance) < radius) {
      const Vec3 arm = cross(at, normal);
      slopes.rate = sample.weight * slope_of_cut_ball(distance / radius) / radius;
      slopes.turn = slopes.rate * arm;
      slopes.stiff = outer_product(slopes.turn, arm);
    }
    slopes_.add_crossed(normal, {weight, weight * at, true}, slopes, reach_.inverse);
    noted_ += weight * normal;
  }
  void add_behind(const SharePiece& piece, Vec3 normal) {
    const Vec3 force = piece.weight * normal;
    slopes_.add_pushed(force, reach_.inverse * piece.at);
    noted_ += force;
  }
  // What is far behind the surface.
  void end_share(Vec3 center, const ToolSum& sum) { add_rest(center, sum); }

 private:
  // What else has been added to the share, at this place.
  void add_rest(Vec3 at, const ToolSum& sum) {
    const Vec3 force = sum.force_terms();
    slopes_.add_pushed(force - noted_, reach_.inverse * at);
    noted_ = force;
  }

  ToolReach reach_;
  ContactSlopes& slopes_;
  Vec3 noted_;  // force of what of the share has been noted
};

// Seen by a camera. For one cell. `Notes`: what is told of each sample beside.
template <class Notes>
class SamplesByFours : public Notes {
 public:
  using Notes::Notes;

  template <class Measure>
  void add(const Measure& measure, const CellSample* samples, std::uint32_t count,
           const DepthSurface& surface, CellResult& result) {
    neighbors_ = kNone;  // of another block
    for (std::uint32_t first = 0; first < count; first += kAtOnce) {
      const std::uint32_t some = count - first < kAtOnce ? count - first : kAtOnce;
      const std::uint32_t found =
          read_samples(surface, measure.to_surface(), {samples + first, some}, readings_);
      for (std::uint32_t k = 0; k < found; ++k)
        add_one(measure, samples, first + readings_[k].sample, readings_[k].at, result);
    }
  }
  // Adds those whose directions were put off, to be found together.
  template <class Measure>
  void flush(const Measure& measure, CellResult& result) {
    if (direction_count_ == 0) return;
    Vec3 normals[kAtOnce];
    closest_normals(measure.surface(), {searched_, direction_count_}, normals);
    for (std::uint32_t k = 0; k < pushed_count_; ++k) {
      const SharePiece piece = piece_of(*pushed_[k].sample);
      const Vec3 normal = normals[pushed_[k].direction];
      measure.add_pushed(piece, normal, result.sum);
      this->add_behind(piece, measure.in_tool(normal));
    }
    direction_count_ = pushed_count_ = 0;
  }

 private:
  static constexpr std::uint32_t kAtOnce = 16;

  template <class Measure>
  void add_one(const Measure& measure, const CellSample* samples, std::uint32_t k,
               const PlaceReading& at, CellResult& result) {
    const SharePiece piece = piece_of(samples[k]);
    const typename Measure::PieceLook look = measure.look_of(piece, at.x, at.reading);
    if (!measure.note(piece, look, result)) return;
    if (!Measure::shares_direction(piece, look)) {
      const SharePiece part = measure.part_behind(piece, look);
      measure.add_pushed(part, look.reading.normal, result.sum);
      this->add_cut(samples[k], part.weight, look.reading.distance,
                    measure.in_tool(look.reading.normal));
      return;
    }
    if (neighbors_ != k / kNeighborSamples) {
      neighbors_ = k / kNeighborSamples;
      if (direction_count_ == kAtOnce) flush(measure, result);
      searched_[direction_count_++] = at;
    }
    pushed_[pushed_count_++] = {samples + k, direction_count_ - 1};
  }

  static constexpr std::uint32_t kNone = UINT32_MAX;
  struct Pushed {
    const CellSample* sample;
    std::uint32_t direction;  // which of those that are searched for
  };

  SampleReading readings_[kAtOnce];
  PlaceReading searched_[kAtOnce];
  Pushed pushed_[kAtOnce * kNeighborSamples];
  std::uint32_t direction_count_ = 0, pushed_count_ = 0;
  std::uint32_t neighbors_ = kNone;  // for which the last direction is searched
};

using SamplesTogether = SamplesByFours<CrossedTogether>;
using SamplesWithSlopes = SamplesByFours<SlopeNotes>;

template <class Surface>
using SamplesOnHost =
    std::conditional_t<std::is_same_v<Surface, DepthSurface>, SamplesTogether, SamplesAmongDisks>;

}  // namespace vpm
