#include "libvpm/mesh/repair_advice.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <utility>
#include <vector>

#include "libvpm/core/error.h"
#include "libvpm/mesh/holes.h"
#include "libvpm/mesh/triangle_bvh.h"
#include "libvpm/mesh/weld.h"

namespace vpm {
namespace {

// Returns the share of the area whose triangles' centres lie within this distance of the other.
double share_near(const Solid& solid, const Solid& other, double within) {
  const TriangleBvh surface(other.vertices, other.triangles);
  double near = 0, all = 0;
  for (const Triangle& t : solid.triangles) {
    const Vec3 a = solid.vertices[t[0]], b = solid.vertices[t[1]], c = solid.vertices[t[2]];
    const double area = norm(cross(b - a, c - a));
    all += area;
    if (surface.closest((a + b + c) / 3, within).triangle != SurfacePoint::kNone) near += area;
  }
  return near / all;
}

// Tries what may mend a mesh, the mildest change first.
class Advice {
 public:
  Advice(const DefectiveMesh& mesh, const MakeSolid& make) : mesh_(mesh), make_(make) {}

  // Returns what makes this mesh pass, found by trying; for a mesh that takes too long to try, what
  // may do so.
  std::string advice() const {
    for (const double weld_by : {1e-6, 1e-5, 1e-4, 1e-3}) {
      if (weld_by <= mesh_.options.weld.value_or(kDefaultWeld) || !closes_by_welding(weld_by))
        continue;
      char text[64];
      std::snprintf(text, sizeof text, "give `weld` %g, which joins parts that nearly meet",
                    weld_by);
      return text;
    }
    constexpr std::size_t kMostFilled = 100'000, kMostRenewed = 20'000, kMostEdgesFilled = 1000;
    if (mesh_.options.repair == Repair::none && mesh_.solid.triangles.size() <= kMostFilled &&
        mesh_.topology.boundary.size() <= kMostEdgesFilled && thickness_by(Repair::holes) > 0) {
      return std::string("give `repair` to ") + (mesh_.topology.boundary.empty()
                                                     ? "drop repeated triangles"
                                                     : "fill planar and small holes");
    }
    if (mesh_.solid.triangles.size() > kMostRenewed)
      return "`repair` holes, voxel or flood may close it, or mend it in a mesh editor";
    const std::string renew = advice_of_new_surface();
    return !renew.empty()
               ? renew
               : "no `repair` closes it: give a sheet a thickness, or mend it in a mesh editor";
  }

 private:
  // Returns which new surface bounds a solid; nothing if none does. What is thin may be a skin
  // beside triangles that face the wrong way, and so a thicker solid goes first.
  std::string advice_of_new_surface() const {
    constexpr double kThick = 3, kThin = 1.5;  // voxels
    char wide[96];
    const double width = widest_hole();
    std::snprintf(wide, sizeof wide, "give `repair` flood and `max_hole` %.3g for a new surface",
                  width);
    std::string thin;
    const auto is_thick = [&](const std::string& advice, double thickness) {
      if (thickness > kThin && thin.empty()) thin = advice;
      return thickness > kThick;
    };
    for (const auto& [repair, advice] :
         {std::pair(Repair::voxel, "give `repair` voxel for a new surface"),
          std::pair(Repair::flood, "give `repair` flood for a new surface")})
      if (is_thick(advice, thickness_by(repair))) return advice;
    if (!mesh_.options.max_hole && is_thick(wide, thickness_by(Repair::flood, width))) return wide;
    return thin;
  }

  // Returns a little more than the width of the widest hole, in metres.
  double widest_hole() const {
    double widest = 0;
    for (const BoundaryLoop& loop : boundary_loops(mesh_.topology, mesh_.solid.triangles))
      widest = std::max(widest, width_of(loop, mesh_.solid.vertices));
    return 1.1 * mesh_.scale * widest;
  }

  // True if most of the mesh lies at a new surface and most of that at the mesh: where triangles
  // face anywhere, a winding number encloses crumbs and skins beside them.
  bool is_kept_by(const CheckedSolid& made) const {
    constexpr double kMostOfMesh = 0.75, kMostOfSolid = 0.6;
    Solid mesh = mesh_.solid;
    for (Vec3& p : mesh.vertices) p = mesh_.scale * p;
    const double voxel = made.facts.voxel_repair->voxel;
    return share_near(mesh, made.solid, 3 * voxel) >= kMostOfMesh &&
           share_near(made.solid, mesh, 1.5 * voxel) >= kMostOfSolid;
  }

  // Returns the mean thickness, in voxels, of the solid that the repair makes of the mesh, tried
  // with few voxels; 0 if it makes none, or crumbs, and no limit where holes were filled.
  double thickness_by(Repair repair, std::optional<double> max_hole = {}) const {
    constexpr int kTriedVoxels = 40;  // a flood's default width is two and a half
    SolidOptions options = mesh_.options;
    options.repair = repair;
    if (max_hole) options.max_hole = max_hole;
    options.repair_voxels = kTriedVoxels;
    try {
      const CheckedSolid made = make_(options);
      if (!made.facts.voxel_repair) return HUGE_VAL;
      if (!is_kept_by(made)) return 0;
      return 2 * made.facts.volume / (made.facts.area * made.facts.voxel_repair->voxel);
    } catch (const Error&) {
      return 0;
    }
  }

  // True if joining vertices closes the mesh and no triangle is lost by it.
  bool closes_by_welding(double share) const {
    std::vector<Triangle> joined = mesh_.solid.triangles;
    const Weld done = weld(mesh_.solid.vertices, share * mesh_.diagonal, joined);
    return done.collapsed_triangles == 0 &&
           is_closed(topology_of(mesh_.solid.vertices.size(), joined));
  }

  static bool is_closed(const Topology& topology) {
    return topology.boundary.empty() && topology.non_manifold.empty() && topology.pinched.empty();
  }

  const DefectiveMesh& mesh_;
  const MakeSolid& make_;
};

}  // namespace

std::string repair_advice(const DefectiveMesh& mesh, const MakeSolid& make) {
  return Advice(mesh, make).advice();
}

}  // namespace vpm
