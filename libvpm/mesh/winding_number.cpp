#include "libvpm/mesh/winding_number.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "libvpm/core/parallel.h"
#include "libvpm/core/solid_angle.h"

namespace vpm {
namespace {

// A group counts as a dipole from this multiple of its radius on. The paper's 2 keeps the error of
// a closed mesh well below the half that decides.
constexpr double kFarFactor = 2.0;
constexpr double kOnTriangle = 1e-12;  // relative to its size; far above rounding

// Returns the solid angle of a triangle; 0 on it, where two coinciding triangles that enclose
// nothing would else count by the signs that rounding chooses.
double solid_angle(Vec3 a, Vec3 b, Vec3 c) {
  const TriangleAngle angle(a, b, c);
  return angle.holds_origin(kOnTriangle) ? 0 : angle.value();
}

struct Group {
  Vec3 area, center;
  double weight = 0;
};

}  // namespace

WindingNumber::WindingNumber(const TriangleBvh& bvh) : bvh_(bvh), dipoles_(4 * bvh.nodes().size()) {
  const auto& nodes = bvh.nodes();
  std::vector<std::array<std::uint32_t, 2>> range(4 * nodes.size());
  // Children follow their parent, so that a backward pass visits them first.
  for (std::size_t n = nodes.size(); n-- > 0;) {
    for (std::size_t slot = 0; slot < 4; ++slot) {
      const std::uint32_t child = nodes[n].child[slot], count = nodes[n].count[slot];
      std::array<std::uint32_t, 2>& all = range[4 * n + slot];
      if (count > 0) {
        all = {child, child + count};
      } else if (child > 0) {
        all = range[4 * std::size_t{child}];
        for (std::size_t k = 1; k < 4; ++k) {
          if (const auto& r = range[4 * std::size_t{child} + k]; r[1] > r[0]) all[1] = r[1];
        }
      }
    }
  }
  const auto fill = [&](std::size_t i) {
    Group group;
    for (std::uint32_t t = range[i][0]; t < range[i][1]; ++t) {
      const TriangleBvh::Corners& c = bvh.corners()[t];
      const Vec3 area = 0.5 * cross(c.b - c.a, c.c - c.a);
      const double weight = norm(area);
      group.area += area;
      group.center +=
          weight *
          (((c.a - bvh.corners()[0].a) + (c.b - bvh.corners()[0].a) + (c.c - bvh.corners()[0].a)) /
           3.0);
      group.weight += weight;
    }
    if (range[i][0] == range[i][1]) return;
    Dipole& dipole = dipoles_[i];
    dipole.area = group.area;
    dipole.center =
        bvh.corners()[0].a + (group.weight > 0 ? group.center / group.weight
                                               : bvh.corners()[range[i][0]].a - bvh.corners()[0].a);
    double radius2 = 0;
    for (std::uint32_t t = range[i][0]; t < range[i][1]; ++t) {
      const TriangleBvh::Corners& c = bvh.corners()[t];
      for (const Vec3 p : {c.a, c.b, c.c})
        radius2 = std::max(radius2, squared_norm(p - dipole.center));
    }
    dipole.far2 = kFarFactor * kFarFactor * radius2;
  };
  constexpr std::size_t kTogether = 1024;
  parallel_for(dipoles_.size(), kTogether, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) fill(i);
  });
}

template <class Counts>
double WindingNumber::enclosures(Vec3 x, Counts counts) const {
  const auto& nodes = bvh_.nodes();
  std::array<std::uint32_t, 64> stack;  // large enough, see TriangleBvh::closest
  std::size_t top = 0;
  stack[top++] = 0;
  double sum = 0;
  while (top > 0) {
    const std::uint32_t n = stack[--top];
    for (std::uint32_t slot = 0; slot < 4; ++slot) {
      const std::uint32_t child = nodes[n].child[slot], count = nodes[n].count[slot];
      if (count == 0 && child == 0) continue;
      const Dipole& dipole = dipoles_[4 * std::size_t{n} + slot];
      const Vec3 to = dipole.center - x;
      const double distance2 = squared_norm(to);
      if (distance2 > dipole.far2) {
        sum += dipole_angle(dipole.area, to, distance2);
      } else if (count == 0) {
        stack[top++] = child;
      } else {
        for (std::uint32_t i = child; i < child + count; ++i) {
          const TriangleBvh::Corners& t = bvh_.corners()[i];
          if (counts(t.triangle)) sum += solid_angle(t.a - x, t.b - x, t.c - x);
        }
      }
    }
  }
  return sum / kFullSolidAngle;
}

double WindingNumber::at(Vec3 x) const {
  return enclosures(x, [](std::uint32_t) { return true; });
}

double WindingNumber::at(Vec3 x, std::span<const std::uint32_t> without) const {
  // No group that holds x counts as a dipole, so each of these triangles is visited.
  return enclosures(x, [&](std::uint32_t t) {
    return std::find(without.begin(), without.end(), t) == without.end();
  });
}

}  // namespace vpm
