#include "libvpm/view/simplify.h"

#include <cmath>
#include <map>

#include "libvpm/core/box.h"

namespace vpm::view {
namespace {

Solid joined_in_cells(const Solid& solid, const Box& box, double cell) {
  std::map<std::array<std::int64_t, 3>, std::uint32_t> numbers;
  std::vector<std::uint32_t> joined;
  std::vector<std::uint32_t> members;
  Solid result;
  for (const Vec3& p : solid.vertices) {
    const Vec3 at = (p - box.low) / cell;
    const auto [it, is_new] =
        numbers.try_emplace({std::llround(at.x), std::llround(at.y), std::llround(at.z)},
                            static_cast<std::uint32_t>(result.vertices.size()));
    if (is_new) result.vertices.push_back({}), members.push_back(0);
    result.vertices[it->second] += p - box.low;
    ++members[it->second];
    joined.push_back(it->second);
  }
  for (std::size_t k = 0; k < members.size(); ++k)
    result.vertices[k] = box.low + result.vertices[k] / members[k];
  for (const Triangle& t : solid.triangles) {
    const Triangle moved{joined[t[0]], joined[t[1]], joined[t[2]]};
    if (moved[0] != moved[1] && moved[1] != moved[2] && moved[2] != moved[0])
      result.triangles.push_back(moved);
  }
  return result;
}

}  // namespace

Solid simplified(const Solid& solid, std::size_t triangles) {
  if (solid.triangles.size() <= triangles) return solid;
  Box box;
  for (const Vec3& p : solid.vertices) box.add(p);
  // A surface of n triangles crosses about n / 2 cells; each cell's side is a part of the
  // longest.
  double cells = std::sqrt(static_cast<double>(triangles));
  const double longest = coordinate(box.size(), box.longest_axis());
  Solid result = joined_in_cells(solid, box, longest / cells);
  while (result.triangles.size() > triangles && cells > 2) {
    cells *= 0.8;
    result = joined_in_cells(solid, box, longest / cells);
  }
  return result;
}

}  // namespace vpm::view
