#include "libvpm/solid/solid_surface.h"

#include <bit>
#include <cmath>
#include <utility>

#include "libvpm/core/box.h"
#include "libvpm/core/error.h"
#include "libvpm/mesh/weld.h"

namespace vpm {
namespace {

constexpr int kGridCells = 64;
// Where the grid tells a depth of fewer than kNearCells of its cells, the distance to the closest
// point is taken instead, since the grid errs by a cell or two near the surface. Over the next
// kMixedCells the depth goes over from that distance to the grid's, so that forces do not jump: at
// creases of the depth the grid errs, however deep.
constexpr double kNearCells = 1.5, kMixedCells = 0.25;

// Returns a well-mixed number from 0 to 1 (the finaliser of MurmurHash3, public domain).
double hashed_fraction(std::uint64_t v) {
  v ^= v >> 33;
  v *= 0xff51afd7ed558ccdull;
  v ^= v >> 33;
  v *= 0xc4ceb9fe1a85ec53ull;
  v ^= v >> 33;
  return static_cast<double>(v >> 11) * 0x1p-53;
}

// Returns an offset within half of the unit cube that depends on the place only.
Vec3 jitter_at(Vec3 x) {
  const auto bits = [](double v) { return std::bit_cast<std::uint64_t>(v + 0.0); };  // -0 is 0
  const std::uint64_t place =
      (bits(x.x) * 0x9e3779b97f4a7c15ull ^ bits(x.y)) * 0xbf58476d1ce4e5b9ull ^ bits(x.z);
  return {hashed_fraction(place + 1) - 0.5, hashed_fraction(place + 2) - 0.5,
          hashed_fraction(place + 3) - 0.5};
}

// Joins equal vertices and drops what collapses.
Solid joined(const Solid& solid) {
  Solid result = solid;
  weld(result.vertices, 0, result.triangles);
  drop_unused(result.vertices, result.triangles);
  return result;
}

}  // namespace

SolidSurface::SolidSurface(const Solid& boundary, bool with_depth) {
  Solid surface = joined(boundary);
  const MassProperties mass = mass_properties(surface);
  if (surface.triangles.empty() || !(mass.volume > 0))
    refuse("the solid has no volume", {}, "give a closed mesh that is oriented outward");
  center_ = mass.center_of_mass;
  reach_ = bounding_radius(surface, center_);
  // Hashes places in units of a power of two near the reach, so that a solid that is scaled by
  // powers of two keeps its jitter.
  int exponent = 0;
  std::frexp(reach_, &exponent);
  for (Vec3& v : surface.vertices) {
    const Vec3 place = v - center_;
    v = place + kJitter * reach_ * jitter_at(std::ldexp(1.0, -exponent) * place);
  }
  hash_ = content_hash(surface);
  tree_ = std::make_unique<SurfaceTree>(surface.vertices, surface.triangles, reach_, with_depth);
  inside_ = std::make_unique<InsideIndex>(tree_->vertices(), tree_->triangles());
  volume_ = tree_->moments(0).flux() / 3;
  for (std::uint32_t t = 0; t < triangles(); ++t) {
    const auto [a, b, c] = tree_->corners(t);
    area_ += 0.5 * norm(cross(b - a, c - a));
  }
  if (with_depth) planes_ = FacePlanes::of(tree_->vertices(), tree_->triangles(), reach_);
  if (with_depth && !planes_) prepare_grid();
}

void SolidSurface::prepare_grid() {
  Box box;
  for (const Vec3& v : tree_->vertices()) box.add(v);
  grid_.emplace(
      box.low, box.high, kGridCells, [&](Vec3 x) { return holds(x); },
      [&](Vec3 x, double within) { return tree_->closest(x, within).distance; });
}

Depth SolidSurface::exact_depth(Vec3 x) const {
  const SurfacePoint nearest = tree_->closest(x);
  const bool in = holds(x);
  const auto [a, b, c] = tree_->corners(nearest.triangle);
  const Vec3 out = x - nearest.point;
  const Vec3 away = nearest.distance > 0 ? (1 / nearest.distance) * out
                                         : -normalized_or_zero(cross(b - a, c - a));
  return {in ? nearest.distance : -nearest.distance, in || nearest.distance == 0 ? away : -away};
}

Depth SolidSurface::depth(Vec3 x) const {
  if (planes_) {
    const Depth below = planes_->depth(x);
    return below.value >= 0 ? below : exact_depth(x);
  }
  const Depth coarse = grid_->at(x);
  const double part = (coarse.value / grid_->cell() - kNearCells) / kMixedCells;  // of the grid's
  if (part >= 1) return coarse;
  const double within = std::max(coarse.value, 0.0) + kNearCells * grid_->cell();
  const SurfacePoint nearest = tree_->closest(x, within);
  if (nearest.triangle == SurfacePoint::kNone) return coarse;
  const auto [a, b, c] = tree_->corners(nearest.triangle);
  const Vec3 normal = normalized_or_zero(cross(b - a, c - a)), out = x - nearest.point;
  const double sign = dot(out, normal) > 0 ? -1 : 1;
  const bool is_on = nearest.distance <= 1e-9 * reach_;
  const Depth exact{sign * nearest.distance, is_on ? -normal : (sign / nearest.distance) * out};
  if (part <= 0) return exact;
  return {exact.value + part * (coarse.value - exact.value),
          exact.gradient + part * (coarse.gradient - exact.gradient)};
}

SphereState SolidSurface::state_of(Vec3 center, double radius) const {
  constexpr double kWrongCells = 2;  // by which the grid errs at creases
  const double coarse = planes_ ? planes_->depth(center).value : grid_->at(center).value,
               sure = planes_ ? radius : radius + kWrongCells * grid_->cell();
  if (coarse > sure) return SphereState::inside;
  if (coarse < -sure) return SphereState::outside;
  if (tree_->closest(center, radius).triangle != SurfacePoint::kNone) return SphereState::boundary;
  return holds(center) ? SphereState::inside : SphereState::outside;
}

std::size_t SolidSurface::bytes() const {
  std::size_t sum = tree_->bytes() + inside_->bytes();
  if (grid_) sum += grid_->bytes();
  if (planes_) sum += planes_->bytes();
  return sum;
}

}  // namespace vpm
