#include "libvpm/mesh/coarse_floats.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "libvpm/core/box.h"

namespace vpm {

std::string coarse_floats(const RawMesh& mesh) {
  constexpr double kCoarse = 1e-4;
  Box box;
  for (const Vec3& p : mesh.vertices) box.add(p);
  if (mesh.vertices.empty()) return "";
  double farthest = 0;
  for (const double c : {box.low.x, box.low.y, box.low.z, box.high.x, box.high.y, box.high.z})
    farthest = std::max(farthest, std::abs(c));
  if (!(farthest <= std::numeric_limits<float>::max())) return "";
  const auto last = static_cast<float>(farthest);
  const double step = double{std::nextafter(last, std::numeric_limits<float>::infinity())} - last;
  const double diagonal = norm(box.size());
  if (!(step > kCoarse * diagonal) || farthest == 0) return "";
  const auto is_float = [](const Vec3& p) { return widen(narrow(p)) == p; };
  if (!std::all_of(mesh.vertices.begin(), mesh.vertices.end(), is_float)) return "";
  char text[200];
  std::snprintf(text, sizeof text,
                "its coordinates lie up to %.3g from the origin, where floats of 32 bits are %.2g "
                "apart, which is coarse for a mesh that is %.3g across",
                farthest, step, diagonal);
  return text;
}

}  // namespace vpm
