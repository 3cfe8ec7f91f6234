#include "libvpm/mesh/outer_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <span>
#include <string>

#include "libvpm/mesh/ray_crossings.h"
#include "libvpm/mesh/triangle_bvh.h"
#include "libvpm/mesh/triangle_cells.h"
#include "libvpm/mesh/winding_number.h"

namespace vpm {
namespace {

using Corners = std::array<Vec3, 3>;

// Triangle with coordinates in its plane.
struct Flat {
  Vec3 a, ab, ac, normal;  // normal of unit length
  Vec3 dual_b, dual_c;     // dot(dual_b, p - a) is the coordinate along ab

  Flat(Vec3 from, Vec3 b, Vec3 c) : a(from), ab(b - from), ac(c - from) {
    const Vec3 n = cross(ab, ac);
    normal = normalized_or_zero(n);
    dual_b = cross(ac, n) / squared_norm(n);
    dual_c = cross(n, ab) / squared_norm(n);
  }
  double height(Vec3 p) const { return dot(normal, p - a); }
  Vec2 flatten(Vec3 p) const { return {dot(dual_b, p - a), dot(dual_c, p - a)}; }
  Vec3 lift(Vec2 p) const { return a + p.x * ab + p.y * ac; }
  bool covers(Vec3 p) const {
    const Vec2 q = flatten(p);
    return q.x >= 0 && q.y >= 0 && q.x + q.y <= 1;
  }
};

// Area that may be lost, relative to the surface's: spheres of the solid's size could pass through
// by less than kCertificateTolerance (packing/certificate.h).
constexpr double kOpen = 1e-9;

// True if the pieces leave no gap. A closed surface has a zero sum of areas, and fluxes of
// coordinates that equal its volume or zero; lost pieces change one of them.
bool is_closed(const Solid& pieces) {
  const Vec3 origin = pieces.vertices.front();
  double area = 0, extent = 0;
  Vec3 sum;
  std::array<Vec3, 3> flux{};
  for (const auto& [i, j, k] : pieces.triangles) {
    const Vec3 a = pieces.vertices[i] - origin, b = pieces.vertices[j] - origin,
               c = pieces.vertices[k] - origin;
    const Vec3 n = 0.5 * cross(b - a, c - a), middle = (a + b + c) / 3;
    area += norm(n);
    extent = std::max(extent, norm(middle));
    sum += n;
    flux[0] += middle.x * n;
    flux[1] += middle.y * n;
    flux[2] += middle.z * n;
  }
  const double volume = (flux[0].x + flux[1].y + flux[2].z) / 3;
  flux[0].x -= volume;
  flux[1].y -= volume;
  flux[2].z -= volume;
  const auto vanishes = [&](Vec3 v) { return norm(v) <= kOpen * area * extent; };
  return norm(sum) <= kOpen * area && vanishes(flux[0]) && vanishes(flux[1]) && vanishes(flux[2]);
}

}  // namespace

// Cuts triangles that meet others, and computes winding numbers.
struct OuterSurface::Cells {
  Cells(const Solid& s, const std::vector<TrianglePair>& contacts)
      : solid(s),
        bvh(s.vertices, s.triangles),
        winding(bvh),
        rays(s.vertices, s.triangles),
        limit(s.triangles.size()),
        begin(s.triangles.size() + 1),
        coplanar(contact_tolerance(s.vertices)) {
    partners.resize(2 * contacts.size());
    for (const auto& [one, other] : contacts) ++begin[one + 1], ++begin[other + 1];
    std::partial_sum(begin.begin(), begin.end(), begin.begin());
    std::vector<std::size_t> next(begin.begin(), begin.end() - 1);
    for (const auto& [one, other] : contacts) {
      partners[next[one]++] = other;
      partners[next[other]++] = one;
    }
  }

  bool is_cut(std::uint32_t t) const { return begin[t] != begin[t + 1]; }
  Vec3 corner(std::uint32_t t, std::size_t k) const {
    return solid.vertices[solid.triangles[t][k]];
  }
  Flat flat(std::uint32_t t) const { return {corner(t, 0), corner(t, 1), corner(t, 2)}; }

  // `number` is the mean winding number of both sides, `step` inner minus outer.
  static Side side_of(double number, double step) {
    const bool in_front = number - 0.5 * step > 0.5, behind = number + 0.5 * step > 0.5;
    if (in_front == behind) return Side::none;
    return behind ? Side::outward : Side::turned;
  }

  // Returns the mean winding number of both sides of x, which lies on the triangles `here`, with
  // the given step between them as seen from the first, which has this plane.
  double number_at(Vec3 x, std::span<const std::uint32_t> here, double step, const Flat& plane,
                   std::uint64_t& work) const {
    constexpr double kAlong = 1e-6;  // sine of the angle below which a ray runs along the triangle
    const double ahead = dot(plane.normal, RayCrossings::kDirection);
    bool doubtful = !(std::abs(ahead) > kAlong);
    int count = 0;
    work += rays.from(x, [&](std::uint32_t t, Crossing crossing) {
      if (std::find(here.begin(), here.end(), t) != here.end()) return;
      doubtful = doubtful || crossing == Crossing::doubtful;
      count += crossing == Crossing::outward ? 1 : -1;
    });
    if (!doubtful) return count + (ahead > 0 ? 0.5 : -0.5) * step;
    work += work::kSolidAngle * (kNearVisits + solid.triangles.size() / kFarShare);
    return winding.at(x, here);
  }

  Side side_of_whole(std::uint32_t t, std::uint64_t& work) const {
    const Vec3 middle = (corner(t, 0) + corner(t, 1) + corner(t, 2)) / 3;
    return side_of(number_at(middle, std::array{t}, 1, flat(t), work), 1);
  }

  // Returns the side of a cell with centre x. The first of several coinciding triangles stands for
  // all.
  Side side_of_cell(std::uint32_t t, const Flat& plane, Vec3 x,
                    const std::vector<std::uint32_t>& in_plane, std::uint64_t& work) const {
    std::vector<std::uint32_t> here{t};
    double step = 1;
    work += 2 * in_plane.size();
    for (const std::uint32_t other : in_plane) {
      const Flat its = flat(other);
      if (!its.covers(x)) continue;
      if (other < t) return Side::none;
      here.push_back(other);
      step += dot(its.normal, plane.normal) > 0 ? 1 : -1;
    }
    return side_of(number_at(x, here, step, plane, work), step);
  }

  // Returns the heights of the corners over the plane, 0 for those in it.
  std::array<double, 3> heights(const Flat& plane, std::uint32_t t) const {
    std::array<double, 3> height{};
    for (std::size_t k = 0; k < 3; ++k) {
      height[k] = plane.height(corner(t, k));
      if (std::abs(height[k]) <= coplanar) height[k] = 0;
    }
    return height;
  }

  // Adds the segments where another triangle meets the plane of this one. Returns false if it lies
  // in that plane.
  bool add_segments(std::uint32_t t, const Flat& plane, std::uint32_t other,
                    std::vector<TriangleSegment>& segments) const {
    const std::array<Vec3, 3> p{corner(other, 0), corner(other, 1), corner(other, 2)};
    const std::array<double, 3> height = heights(plane, other), flat_height{};
    // Tests both ways, so that both triangles get the same answer.
    if (height == flat_height || heights(flat(other), t) == flat_height) {
      for (std::size_t k = 0; k < 3; ++k)
        segments.push_back({plane.flatten(p[k]), plane.flatten(p[(k + 1) % 3])});
      return false;
    }
    std::vector<Vec2> ends;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t l = (k + 1) % 3;
      if (height[k] == 0) ends.push_back(plane.flatten(p[k]));
      if (height[k] * height[l] < 0)
        ends.push_back(plane.flatten(p[k] + height[k] / (height[k] - height[l]) * (p[l] - p[k])));
    }
    if (ends.size() == 2) segments.push_back({ends[0], ends[1]});
    return true;
  }

  // Returns the parts of an intersecting triangle that bound the solid, facing outward; some of
  // them once its work is more than `most_work`.
  std::vector<Corners> pieces_of_cut(std::uint32_t t, std::uint64_t most_work,
                                     std::uint64_t& work) const {
    const Flat plane = flat(t);
    std::vector<TriangleSegment> segments;
    std::vector<std::uint32_t> in_plane;
    for (std::size_t k = begin[t]; k < begin[t + 1]; ++k) {
      if (!add_segments(t, plane, partners[k], segments)) in_plane.push_back(partners[k]);
    }
    work += work::kTriangles * (begin[t + 1] - begin[t]);
    std::vector<Corners> pieces;
    for (const std::vector<Vec2>& cell : triangle_cells(segments, most_work, work)) {
      if (cell.size() < 3) continue;
      if (work > most_work) break;
      Vec2 middle;
      for (const Vec2& p : cell) middle = {middle.x + p.x, middle.y + p.y};
      const auto corners = static_cast<double>(cell.size());
      const Side side = side_of_cell(t, plane, plane.lift({middle.x / corners, middle.y / corners}),
                                     in_plane, work);
      if (side == Side::none) continue;
      const Vec3 first = plane.lift(cell[0]);
      for (std::size_t k = 2; k < cell.size(); ++k)
        pieces.push_back(faced(side, first, plane.lift(cell[k - 1]), plane.lift(cell[k])));
      work += work::kPiece * cell.size();
    }
    return pieces;
  }

  static Corners faced(Side side, Vec3 a, Vec3 b, Vec3 c) {
    return side == Side::outward ? Corners{a, b, c} : Corners{a, c, b};
  }

  Solid surface(const std::vector<Side>& side) {
    std::vector<std::vector<Corners>> pieces(side.size());
    // One triangle may take a small part of all work, which bounds what a round takes.
    const std::uint64_t most_work = limit.most() / kLargestShare;
    const auto work_of = [&](std::size_t k) {
      const auto t = static_cast<std::uint32_t>(k);
      std::uint64_t work = 0;
      if (side[t] == Side::cut) {
        pieces[t] = pieces_of_cut(t, most_work, work);
      } else if (side[t] != Side::none) {
        pieces[t] = {faced(side[t], corner(t, 0), corner(t, 1), corner(t, 2))};
      }
      return work > most_work ? limit.most() : work;
    };
    if (!run_within(limit, side.size(), work_of, progress)) refuse_work();
    Solid result;
    for (const std::vector<Corners>& some : pieces) {
      for (const Corners& p : some) {
        const auto next = static_cast<std::uint32_t>(result.vertices.size());
        result.triangles.push_back({next, next + 1, next + 2});
        result.vertices.insert(result.vertices.end(), p.begin(), p.end());
      }
    }
    return result;
  }

  // Names the triangle that meets the most others.
  [[noreturn]] void refuse_work() const {
    std::uint32_t worst = 0;
    for (std::uint32_t t = 0; t + 1 < begin.size(); ++t) {
      if (begin[t + 1] - begin[t] > begin[worst + 1] - begin[worst]) worst = t;
    }
    throw TooMuchWork(
        "the mesh meets itself in so many places that the boundary of what it encloses cannot be "
        "cut out: " +
            std::to_string(partners.size() / 2) + " pairs of its " +
            std::to_string(solid.triangles.size()) + " triangles meet, " +
            std::to_string(begin[worst + 1] - begin[worst]) + " of them with one triangle",
        (corner(worst, 0) + corner(worst, 1) + corner(worst, 2)) / 3,
        "delete doubled or tangled parts, or give `repair` voxel for a new surface");
  }

  // Share of a large mesh's triangles that a winding number visits, and the number that it visits
  // of any: counts what is near, as dipoles take the rest.
  static constexpr std::size_t kFarShare = 16;
  static constexpr std::uint64_t kNearVisits = 64;
  static constexpr std::uint64_t kLargestShare = 8;

  const Solid& solid;
  TriangleBvh bvh;
  WindingNumber winding;
  RayCrossings rays;
  WorkLimit limit;
  MeshProgress progress;
  std::vector<std::size_t> begin;  // row offsets of `partners`
  std::vector<std::uint32_t> partners;
  double coplanar;  // m
};

void OuterSurface::find_sides(Cells& cells, const Topology& topology) {
  const auto count = static_cast<std::uint32_t>(side_.size());
  // Sides continue between triangles that meet no other: one answer per connected part, for its
  // widest triangle.
  std::vector<std::uint32_t> part, widest, part_of(count, Topology::kNone);
  for (std::uint32_t seed = 0; seed < count; ++seed) {
    if (cells.is_cut(seed)) side_[seed] = Side::cut;
    if (side_[seed] == Side::cut || part_of[seed] != Topology::kNone) continue;
    const auto index = static_cast<std::uint32_t>(widest.size());
    part.assign(1, seed);
    part_of[seed] = index;
    widest.push_back(seed);
    double largest = 0;
    for (std::size_t k = 0; k < part.size(); ++k) {
      const std::uint32_t t = part[k];
      const Vec3 a = cells.corner(t, 0);
      const double area2 = squared_norm(cross(cells.corner(t, 1) - a, cells.corner(t, 2) - a));
      if (area2 > largest) largest = area2, widest[index] = t;
      for (const std::uint32_t other : topology.neighbor[t]) {
        if (other == Topology::kNone || cells.is_cut(other) || part_of[other] != Topology::kNone)
          continue;
        part_of[other] = index;
        part.push_back(other);
      }
    }
  }
  std::vector<Side> side(widest.size());
  const auto work_of = [&](std::size_t k) {
    std::uint64_t work = 0;
    side[k] = cells.side_of_whole(widest[k], work);
    return work;
  };
  if (!run_within(cells.limit, widest.size(), work_of)) cells.refuse_work();
  for (std::uint32_t t = 0; t < count; ++t) {
    if (part_of[t] != Topology::kNone) side_[t] = side[part_of[t]];
  }
}

OuterSurface::OuterSurface(const Solid& solid, const std::vector<TrianglePair>& contacts,
                           const MeshProgress& progress)
    : side_(solid.triangles.size(), Side::outward) {
  const Topology topology = topology_of(solid.vertices.size(), solid.triangles);
  std::size_t shell_count = 0;
  shells_of(topology, shell_count);
  if (!contacts.empty() || shell_count > 1) {
    side_.assign(side_.size(), Side::unknown);
    Cells cells(solid, contacts);
    cells.progress = progress;
    find_sides(cells, topology);
    if (std::any_of(side_.begin(), side_.end(), [](Side s) { return s != Side::outward; }))
      surface_ = cells.surface(side_);
  }
  mass_ = mass_properties(surface_ ? *surface_ : solid);
}

Solid enclosed_surface(const Solid& solid) {
  if (solid.triangles.empty()) return solid;
  const OuterSurface outer(solid, find_contacts(solid.vertices, solid.triangles));
  return outer.surface() ? *outer.surface() : solid;
}

Enclosure enclosure_of(const OuterSurface& outer) {
  const bool cut = outer.surface() && !outer.surface()->triangles.empty();
  const bool closed = !cut || is_closed(*outer.surface());
  return {cut && closed ? outer.surface() : std::nullopt, closed, outer.mass().volume};
}

Enclosure enclosure_of(const Solid& solid) {
  return enclosure_of(OuterSurface(solid, find_contacts(solid.vertices, solid.triangles)));
}

MassProperties enclosed_mass(const Solid& solid) {
  return mass_properties(enclosed_surface(solid));
}

}  // namespace vpm
