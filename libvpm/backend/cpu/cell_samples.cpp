#include "libvpm/backend/cpu/cell_samples.h"

#include <iterator>
#include <type_traits>

#include "libvpm/core/lanes.h"
#include "libvpm/core/vec3x4.h"
#include "libvpm/scene/piece_shape.h"

namespace vpm {
namespace {

using FourSamples = SurfaceSampleOf<Double4>;

// Samples a surface at four places. Two kinds of places may get any distance that tells no more
// than what they are: those surely more than `enough`, m, before the surface, and those surely
// between `enough` and `deepest`, m, behind it.
[[gnu::always_inline]] inline FourSamples sample_at(const DepthSurface& surface, const Vec3x4& x,
                                                    const Double4& /*enough*/, double /*deepest*/) {
  return surface.sample_and(x, [](const Int4&, const Int4&) {});
}
[[gnu::always_inline]] inline FourSamples sample_at(const RigSurface::View& surface,
                                                    const Vec3x4& x, const Double4& enough,
                                                    double deepest) {
  return surface.rig->sample_near(x, surface.cameras, enough, deepest);
}
// Joins four known samples into lanes.
[[gnu::always_inline]] inline FourSamples joined(const SurfaceSample& a, const SurfaceSample& b,
                                                 const SurfaceSample& c, const SurfaceSample& d) {
  FourSamples four;
  four.known = ~Mask4{};
  four.distance = Double4{a.distance, b.distance, c.distance, d.distance};
  four.normal = {a.normal, b.normal, c.normal, d.normal};
  four.foot = {a.foot, b.foot, c.foot, d.foot};
  four.point = Int4{static_cast<std::int32_t>(a.point), static_cast<std::int32_t>(b.point),
                    static_cast<std::int32_t>(c.point), static_cast<std::int32_t>(d.point)};
  return four;
}
[[gnu::always_inline]] inline SurfaceSample of_lane(const FourSamples& four, int lane) {
  if (four.known[lane] == 0) return {};
  return {true, four.distance[lane], four.normal.of(lane), four.foot.of(lane),
          static_cast<std::uint32_t>(four.point[lane])};
}

template <class Surface>
[[gnu::always_inline]] inline void sample_lanes(const Surface& surface, const Vec3 (&places)[4],
                                                SurfaceSample (&on_surface_at)[4]) {
  const FourSamples four =
      sample_at(surface, {places[0], places[1], places[2], places[3]}, Double4{} + HUGE_VAL, 0);
  for (int k = 0; k < kFour; ++k) on_surface_at[k] = of_lane(four, k);
}

// Calls use(center, weight, shape, farthest) for four samples of a block, from `first` on: with
// their shape, and how far it reaches at most, m. Without kHaveFaces none of them may be in a row.
// Lanes past the last sample repeat it, without weight in a row.
template <bool kHaveFaces, class Use>
[[gnu::always_inline]] inline void with_four(std::span<const CellSample> samples,
                                             std::uint32_t first, const SampleFaces& faces,
                                             const Use& use) {
  static_assert(FaceRow::kLanes == kFour);
  if constexpr (kHaveFaces) {
    if (samples[first].radius < 0) {
      const FaceRow& row = faces.row_of(samples[first]);
      const auto lanes = [&](FaceRow::Number number) __attribute__((always_inline)) {
        return widen(load<Float4>(row.numbers + number * kFour));
      };
      return use(Vec3x4(lanes(FaceRow::x), lanes(FaceRow::y), lanes(FaceRow::z)),
                 load<Double4>(row.weights), face_shape<Double4>(lanes), lanes(FaceRow::farthest));
    }
  }
  const auto [a, b, c, d] = four_of(samples, first);
  const BallShape<Double4> ball{widen(Float4{a.radius, b.radius, c.radius, d.radius})};
  use(Vec3x4(a.center, b.center, c.center, d.center),
      Double4{a.weight, b.weight, c.weight, d.weight}, ball, ball.radius);
}

template <class Shape>
constexpr bool kIsBall = std::is_same_v<std::remove_cvref_t<Shape>, BallShape<Double4>>;

template <bool kHaveFaces, class Surface>
[[gnu::always_inline]] inline std::uint32_t sample_lanes(const Surface& surface,
                                                         const Pose& to_surface,
                                                         std::span<const CellSample> samples,
                                                         const SampleFaces& faces, double deepest,
                                                         SurfaceOfSample* on_surface_at) {
  const auto count = static_cast<std::uint32_t>(samples.size());
  std::uint32_t found = 0;
  for (std::uint32_t first = 0; first < count; first += kFour) {
    with_four<kHaveFaces>(
        samples, first, faces,
        [&](const Vec3x4& center, const Double4&, const auto& shape,
            const Double4& farthest) __attribute__((always_inline)) {
          const Vec3x4 x = to_surface * center;
          const FourSamples four = sample_at(surface, x, farthest, deepest);
          const Vec3x4 normal =
              kIsBall<decltype(shape)> ? four.normal : transpose(to_surface.rotation) * four.normal;
          const Mask4 wanted = negated(four.known) | (four.distance < shape.reach_toward(normal));
          if (!any(wanted)) return;
          for (int k = 0; k < kFour && first + k < count; ++k) {
            if (wanted[k] != 0) on_surface_at[found++] = {first + k, {x.of(k), of_lane(four, k)}};
          }
        });
  }
  return found;
}

// Writes search(x, sample) of the sampled places.
template <class Search>
[[gnu::always_inline]] inline void search_lanes(std::span<const PlaceSample> places, Vec3* normals,
                                                const Search& search) {
  const std::size_t count = places.size();
  for (std::size_t first = 0; first < count; first += kFour) {
    const auto [a, b, c, d] = four_of(places, first);
    const Vec3x4 normal = search(Vec3x4(a.x, b.x, c.x, d.x),
                                 joined(a.on_surface, b.on_surface, c.on_surface, d.on_surface));
    for (int k = 0; k < kFour && first + k < count; ++k) normals[first + k] = normal.of(k);
  }
}

// Adds the parts that were not seen at their centroids.
template <class Surface>
[[gnu::always_inline]] inline void add_unseen_lanes(const Surface& surface, const Pose& to_surface,
                                                    const FreeParts& parts, UnseenSum& unseen) {
  static_assert(FreeParts::kPadding >= kFour - 1);
  for (std::size_t first = 0; first < parts.count; first += kFour) {
    const Vec3x4 centroid(load<Double4>(parts.x + first), load<Double4>(parts.y + first),
                          load<Double4>(parts.z + first));
    const auto [is_in_image, is_seen] = surface.view_of(to_surface * centroid);
    if (all(is_seen)) continue;
    for (std::size_t k = 0; k < kFour && first + k < parts.count; ++k) {
      if (is_seen[k] == 0)
        unseen.add(parts.weight[first + k], is_in_image[k] != 0 ? Sight::hole : Sight::out_of_view);
    }
  }
}

// Holds four rows of partial sums, one in each lane.
struct FourRows {
  Double4 weight{};
  Vec3x4 moment{Double4{}, Double4{}, Double4{}};
};

[[gnu::always_inline]] inline FourRows operator+(const FourRows& a, const FourRows& b) {
  return {a.weight + b.weight, a.moment + b.moment};
}
// Adds lanes by halves, as clipped_in_turn() does.
[[gnu::always_inline]] inline double sum(const Double4& rows) {
  return (rows[0] + rows[2]) + (rows[1] + rows[3]);
}

template <bool kHaveFaces>
[[gnu::always_inline]] inline ClippedMoments clipped_lanes(const ClipPlane& plane,
                                                           std::span<const CellSample> samples,
                                                           const SampleFaces& faces) {
  const auto count = static_cast<std::uint32_t>(samples.size());
  FourRows rows[kSumRows / kFour];
  Mask4 any_cut{};
  for (std::uint32_t first = 0; first < count; first += kFour) {
    with_four<kHaveFaces>(
        samples, first, faces,
        [&](const Vec3x4& center, const Double4& weight, const auto& shape, const Double4& farthest)
            __attribute__((always_inline)) {
              const Double4 distance = dot(plane.normal, center) + plane.height;
              if (!any(distance < farthest)) return;
              Mask4 is_cut{};
              Double4 inside = weight_behind(shape, plane.normal, distance, weight, is_cut);
              any_cut |= is_cut;
              if (kIsBall<decltype(shape)>)
                for (std::uint32_t k = count - first; k < kFour; ++k) inside[k] = 0;
              FourRows& row = rows[first / kFour % std::size(rows)];
              row = row + FourRows{inside, inside * center};
            });
  }
  static_assert(std::size(rows) == 4);
  const FourRows all = (rows[0] + rows[2]) + (rows[1] + rows[3]);
  return {sum(all.weight), {sum(all.moment.x), sum(all.moment.y), sum(all.moment.z)}, any(any_cut)};
}

}  // namespace

VPM_VECTOR_CLONES
void sample_four(const DepthSurface& surface, const Vec3 (&places)[4],
                 SurfaceSample (&on_surface_at)[4]) {
  sample_lanes(surface, places, on_surface_at);
}
VPM_AVX2_CLONES
void sample_four(const RigSurface::View& surface, const Vec3 (&places)[4],
                 SurfaceSample (&on_surface_at)[4]) {
  sample_lanes(surface, places, on_surface_at);
}
void sample_four(const RigSurface& surface, const Vec3 (&places)[4],
                 SurfaceSample (&on_surface_at)[4]) {
  sample_four(RigSurface::View{&surface, surface.all_cameras()}, places, on_surface_at);
}

VPM_VECTOR_CLONES
std::uint32_t sample_surface(const DepthSurface& surface, const Pose& to_surface,
                             std::span<const CellSample> samples, const SampleFaces& faces,
                             double deepest, SurfaceOfSample* on_surface_at) {
  return have_faces(samples.data(), samples.size())
             ? sample_lanes<true>(surface, to_surface, samples, faces, deepest, on_surface_at)
             : sample_lanes<false>(surface, to_surface, samples, faces, deepest, on_surface_at);
}
VPM_AVX2_CLONES
std::uint32_t sample_surface(const RigSurface::View& surface, const Pose& to_surface,
                             std::span<const CellSample> samples, const SampleFaces& faces,
                             double deepest, SurfaceOfSample* on_surface_at) {
  return have_faces(samples.data(), samples.size())
             ? sample_lanes<true>(surface, to_surface, samples, faces, deepest, on_surface_at)
             : sample_lanes<false>(surface, to_surface, samples, faces, deepest, on_surface_at);
}

VPM_VECTOR_CLONES
void add_unseen(const DepthSurface& surface, const Pose& to_surface, const FreeParts& parts,
                UnseenSum& unseen) {
  add_unseen_lanes(surface, to_surface, parts, unseen);
}
VPM_AVX2_CLONES
void add_unseen(const RigSurface& surface, const Pose& to_surface, const FreeParts& parts,
                UnseenSum& unseen) {
  add_unseen_lanes(surface, to_surface, parts, unseen);
}

VPM_VECTOR_CLONES
void closest_normals(const DepthSurface& surface, std::span<const PlaceSample> places,
                     Vec3* normals) {
  search_lanes(
      places,
      normals, [&](const Vec3x4& x, const FourSamples& on_surface) __attribute__((always_inline)) {
        return search_normal(surface, x, on_surface);
      });
}
VPM_AVX2_CLONES
void closest_normals(const RigSurface& surface, std::span<const PlaceSample> places,
                     Vec3* normals) {
  search_lanes(
      places,
      normals, [&](const Vec3x4& x, const FourSamples& on_surface) __attribute__((always_inline)) {
        return surface.closest_normal(x, on_surface);
      });
}

namespace {

VPM_VECTOR_CLONES
ClippedMoments clipped_balls(const ClipPlane& plane, std::span<const CellSample> samples) {
  return clipped_lanes<false>(plane, samples, {});
}
VPM_VECTOR_CLONES
ClippedMoments clipped_beside_faces(const ClipPlane& plane, std::span<const CellSample> samples,
                                    const SampleFaces& faces) {
  return clipped_lanes<true>(plane, samples, faces);
}

}  // namespace

ClippedMoments clipped_moments(const ClipPlane& plane, const CellSample* samples,
                               std::uint32_t count, const SampleFaces& faces) {
  return have_faces(samples, count) ? clipped_beside_faces(plane, {samples, count}, faces)
                                    : clipped_balls(plane, {samples, count});
}

VPM_VECTOR_CLONES
std::uint32_t add_section(const ClipPlane& plane, std::span<const CellSample> samples,
                          const SampleFaces& faces, CellSection& cell) {
  const auto count = static_cast<std::uint32_t>(samples.size());
  CellSectionOf<Double4> lanes;
  std::uint32_t bits = 0;
  for (std::uint32_t first = 0; first < count; first += kFour) {
    Mask4 is_behind;
    with_four<true>(
        samples, first, faces,
        [&](const Vec3x4& center, Double4 weight, const auto& shape, const Double4&)
            __attribute__((always_inline)) {
              for (std::uint32_t k = count - first; k < kFour; ++k) weight[k] = 0;
              is_behind = lanes.add(shape, center, weight, plane);
            });
    for (std::uint32_t k = 0; k < kFour; ++k) bits |= (is_behind[k] != 0 ? 1U : 0U) << (first + k);
  }
  cell.weight += sum(lanes.weight);
  cell.moment += {sum(lanes.moment.x), sum(lanes.moment.y), sum(lanes.moment.z)};
  cell.below += sum(lanes.below);
  cell.section += sum(lanes.section);
  return bits;
}

}  // namespace vpm
