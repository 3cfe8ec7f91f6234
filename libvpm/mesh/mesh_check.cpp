#include "libvpm/mesh/mesh_check.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <utility>

#include "libvpm/core/box.h"
#include "libvpm/core/error.h"
#include "libvpm/mesh/holes.h"
#include "libvpm/mesh/mesh_reader.h"
#include "libvpm/mesh/predicates.h"
#include "libvpm/mesh/repair_advice.h"
#include "libvpm/mesh/self_intersection.h"
#include "libvpm/mesh/shells.h"
#include "libvpm/mesh/topology.h"
#include "libvpm/mesh/weld.h"

namespace vpm {
namespace {

// Range of extents, m, in which the products of the measure (fourth powers of lengths) are in the
// range of doubles.
constexpr double kSmallestExtent = 1e-30, kLargestExtent = 1e30;
// Least volume relative to area times diagonal. Rounding gives a flat closed mesh about 1e-16; the
// thinnest plate worth packing has far more.
constexpr double kFlat = 1e-12;
constexpr const char* kMoveToOrigin = "move it to the origin before it is saved";

std::string text_of(Vec3 p) {
  char text[96];
  std::snprintf(text, sizeof text, "(%.6g, %.6g, %.6g)", p.x, p.y, p.z);
  return text;
}

std::string counted(std::size_t count, const std::string& thing, const std::string& things) {
  return std::to_string(count) + " " + (count == 1 ? thing : things);
}

// Returns ", at A and more": the first place of a list.
template <class T, class Place>
std::string first_place(const std::vector<T>& list, Place place) {
  return list.empty() ? "" : ", at " + place(list.front()) + (list.size() > 1 ? " and more" : "");
}

Box box_of(const std::vector<Vec3>& vertices, const std::vector<Triangle>& triangles) {
  Box box;
  for (const Triangle& t : triangles)
    for (const std::uint32_t corner : t) box.add(vertices[corner]);
  return box;
}

double area_of(const Solid& solid) {
  double area = 0;
  for (const Triangle& t : solid.triangles) {
    const Vec3 a = solid.vertices[t[0]];
    area += 0.5 * norm(cross(solid.vertices[t[1]] - a, solid.vertices[t[2]] - a));
  }
  return area;
}

// Takes one mesh from raw triangles to the solid; each step is one check.
class Check {
 public:
  Check(const RawMesh& mesh, const SolidOptions& options, const MeshProgress& progress)
      : mesh_(mesh), options_(options), progress_(progress) {
    result_.facts.format = mesh.format;
    result_.notes = mesh.notes;
    vertices() = mesh.vertices;
    triangles() = triangulate(mesh);
  }

  CheckedSolid run() {
    try {
      return checked();
    } catch (const TooMuchWork& fault) {
      refuse(fault.problem() + ", at " + text_of(fault.at / unit_), mesh_.name, fault.hint());
    }
  }

 private:
  CheckedSolid checked() {
    if (triangles().empty()) refuse_faceless();
    check_extent();
    const std::size_t repeated = drop_collapsed(triangles());
    facts().collapsed_triangles += repeated;
    join_vertices();
    report_dropped();
    if (triangles().empty()) refuse_empty();
    if (options_.repair == Repair::voxel || options_.repair == Repair::flood) remesh();
    topology_ = topology_of(vertices().size(), triangles());
    close_by_welding();
    if (options_.repair == Repair::holes) repair_holes();
    refuse_defects();
    // Joined vertices are unused too, but were used in the file; a new surface has none of them.
    const std::size_t joined = facts().voxel_repair ? 0 : facts().joined_vertices;
    facts().unused_vertices = drop_unused(vertices(), triangles()) - joined;
    if (facts().unused_vertices > 0)
      note(counted(facts().unused_vertices, "vertex", "vertices") + " without a triangle dropped");
    orient();
    for (Vec3& p : vertices()) p = scale_ * p;
    unit_ = scale_;
    look_for_self_intersections();
    drop_inner_shells();
    measure();
    return std::move(result_);
  }

  std::vector<Vec3>& vertices() { return result_.solid.vertices; }
  std::vector<Triangle>& triangles() { return result_.solid.triangles; }
  MeshFacts& facts() { return result_.facts; }

  void check_extent() {
    const Box box = box_of(vertices(), triangles());
    const Vec3 size = scale_ * (box.high - box.low);
    const double extent = std::max({size.x, size.y, size.z});
    const double farthest =
        scale_ * std::max({std::abs(box.low.x), std::abs(box.low.y), std::abs(box.low.z),
                           std::abs(box.high.x), std::abs(box.high.y), std::abs(box.high.z)});
    diagonal_ = norm(box.high - box.low);
    if (extent == 0) refuse("all triangles lie in one point", mesh_.name);
    if (!(extent >= kSmallestExtent && farthest <= kLargestExtent)) {
      refuse("the mesh reaches from " + text_of(box.low) + " to " + text_of(box.high) +
                 ", which leaves the range of 1e-30 to 1e30 m",
             mesh_.name, "give `scale`");
    }
  }

  void join_vertices() {
    const bool is_soup = lists_corners(mesh_.format) || options_.repair != Repair::none;
    if (!is_soup && !options_.weld.has_value()) return;
    const Weld done =
        weld(vertices(), options_.weld.value_or(kDefaultWeld) * diagonal_, triangles());
    facts().joined_vertices = done.joined_vertices;
    facts().collapsed_triangles += done.collapsed_triangles;
  }

  void report_dropped() {
    if (facts().collapsed_triangles == 0) return;
    note(counted(facts().collapsed_triangles, "triangle", "triangles") +
         " with two equal corners dropped");
  }

  [[noreturn]] void refuse_faceless() const {
    if (mesh_.dropped_polygons > 0)
      refuse("the mesh has no faces of three corners or more", mesh_.name);
    if (mesh_.vertices.empty())
      refuse("this is no mesh: it has no vertices and no faces", mesh_.name,
             "give the file that was meant, as OBJ, PLY or STL");
    refuse("the mesh has no faces, only " + counted(mesh_.vertices.size(), "vertex", "vertices"),
           mesh_.name, "save it with its faces; a cloud of points is for vpm-normals");
  }

  [[noreturn]] void refuse_empty() const {
    refuse("every triangle has two equal corners; the mesh has no surface", mesh_.name);
  }

  // Formats with indices may still list a point twice, e.g. at a seam of textures.
  void close_by_welding() {
    if (topology_.boundary.empty() || lists_corners(mesh_.format) || options_.weld.has_value())
      return;
    std::vector<Triangle> joined = triangles();
    const Weld done = weld(vertices(), kDefaultWeld * diagonal_, joined);
    if (done.joined_vertices == 0 || joined.empty()) return;
    Topology topology = topology_of(vertices().size(), joined);
    if (!topology.boundary.empty() || !topology.non_manifold.empty()) return;
    note("the mesh was open and is closed after joining " +
         counted(done.joined_vertices, "vertex", "vertices") + " to others at the same place");
    facts().joined_vertices = done.joined_vertices;
    facts().collapsed_triangles += done.collapsed_triangles;
    triangles() = std::move(joined);
    topology_ = std::move(topology);
  }

  void remesh() {
    const bool is_flood = options_.repair == Repair::flood;
    const Box box = box_of(vertices(), triangles());
    const Vec3 size = box.high - box.low;
    const double longest = std::max({size.x, size.y, size.z});
    const double max_hole = options_.max_hole ? *options_.max_hole / scale_
                            : is_flood        ? kDefaultMaxHole * longest
                                              : HUGE_VAL;
    if (is_flood && max_hole > diagonal_) {
      char text[160];
      std::snprintf(
          text, sizeof text,
          "`max_hole` %.3g m is more than the mesh is across, %.3g m: nothing of it would "
          "be reached from outside; is it in metres?",
          scale_ * max_hole, scale_ * diagonal_);
      throw Error(ErrorKind::invalid_argument, text);
    }
    refuse_wide_holes(max_hole);
    VoxelRepair done;
    if (is_flood) {
      result_.solid = repair_by_flood(result_.solid, options_.repair_voxels, max_hole, done);
    } else if (orient_outward(result_.solid)) {
      result_.solid = repair_by_winding_number(result_.solid, options_.repair_voxels, done);
    } else {
      refuse("the surface is one-sided (like a Moebius band), and has no winding number",
             mesh_.name, "where it encloses something all the same, give `repair` flood");
    }
    if (triangles().empty()) {
      const std::string voxel =
          "no voxel of 1/" + std::to_string(options_.repair_voxels) + " of the longest side ";
      refuse(voxel + (is_flood ? "is closed off from outside" : "lies inside of the mesh"),
             mesh_.name,
             is_flood ? "give a wider `max_hole`, or more voxels"
                      : "give more voxels (`repair_voxels`), or turn triangles that face inward");
    }
    done.max_hole = std::isfinite(max_hole) ? scale_ * max_hole : 0;
    done.voxel *= scale_;
    done.solid_to_mesh *= scale_;
    done.mesh_to_solid *= scale_;
    facts().voxel_repair = done;
    char text[160];
    std::snprintf(text, sizeof text,
                  "a new surface from voxels of %.3g m: at most %.3g m from the mesh, and the mesh "
                  "at most %.3g m from it",
                  done.voxel, done.solid_to_mesh, done.mesh_to_solid);
    note(text);
  }

  void refuse_wide_holes(double max_hole) {
    const Topology topology = topology_of(vertices().size(), triangles());
    for (const BoundaryLoop& loop : boundary_loops(topology, triangles())) {
      const double width = width_of(loop, vertices());
      if (width <= max_hole) continue;
      char text[160];
      std::snprintf(text, sizeof text, "a hole is %.3g m wide, more than %.3g m, through ",
                    scale_ * width, scale_ * max_hole);
      refuse(text + place_of(loop), mesh_.name, "close it, or give a wider `max_hole`");
    }
  }

  struct Filling {
    std::size_t repeated = 0;  // triangles that were dropped
    std::vector<FilledHole> holes;
    Topology topology;  // sides of the triangles that result
  };

  // Drops repeated triangles and fills holes.
  Filling fill(std::vector<Vec3>& points, std::vector<Triangle>& list) const {
    Filling done;
    done.repeated = drop_repeated(list);
    done.topology = topology_of(points.size(), list);
    if (done.topology.boundary.empty()) return done;
    orient_consistently(done.topology, list);
    done.topology = topology_of(points.size(), list);  // turned triangles have other sides
    done.holes = fill_holes(done.topology, diagonal_, points, list).filled;
    done.topology = topology_of(points.size(), list);
    return done;
  }

  void repair_holes() {
    Filling done = fill(vertices(), triangles());
    facts().repeated_triangles = done.repeated;
    if (done.repeated > 0)
      note(counted(done.repeated, "repeated triangle", "repeated triangles") + " dropped");
    for (FilledHole& hole : done.holes) {
      note("filled a " + std::string(hole.planar ? "planar" : "small") + " hole of " +
           counted(hole.edges, "edge", "edges") + " about " + text_of(hole.center));
      hole.center = scale_ * hole.center;
      hole.size *= scale_;
    }
    facts().filled_holes = std::move(done.holes);
    topology_ = std::move(done.topology);
  }

  // Returns where a hole is: a corner of its rim.
  std::string place_of(const BoundaryLoop& loop) const {
    return text_of(result_.solid.vertices[loop.vertices.front()]);
  }

  // Returns "8 edges of one triangle in 2 holes, the largest a loop of 5 edges through A".
  std::string text_of_holes() const {
    const std::vector<BoundaryLoop> loops = boundary_loops(topology_, result_.solid.triangles);
    const BoundaryLoop& largest = loops.front();
    const std::size_t edges = largest.vertices.size() - (largest.closed ? 0 : 1);
    return counted(topology_.boundary.size(), "edge", "edges") + " of one triangle in " +
           counted(loops.size(), "hole, ", "holes, the largest ") +
           (largest.closed ? "a loop" : "a rim") +
           (loops.size() > 1 ? " of " + counted(edges, "edge", "edges") : "") + " through " +
           place_of(largest);
  }

  void refuse_defects() {
    const auto edge_place = [&](const Edge& e) {
      return text_of(vertices()[e.a]) + "-" + text_of(vertices()[e.b]);
    };
    const auto vertex_place = [&](std::uint32_t v) { return text_of(vertices()[v]); };
    std::string defects;
    const auto add = [&](const std::string& defect) {
      defects += (defects.empty() ? "" : "; ") + defect;
    };
    if (!topology_.boundary.empty()) add("the mesh is open: " + text_of_holes());
    if (!topology_.non_manifold.empty()) {
      add((defects.empty() ? "the mesh is non-manifold: " : "and non-manifold: ") +
          counted(topology_.non_manifold.size(), "edge belongs", "edges belong") +
          " to more than two triangles" +
          (defects.empty() ? first_place(topology_.non_manifold, edge_place) : ""));
    }
    if (topology_.boundary.empty() && !topology_.pinched.empty()) {
      add("the mesh is non-manifold: the surface touches itself in " +
          counted(topology_.pinched.size(), "vertex", "vertices") +
          first_place(topology_.pinched, vertex_place));
    }
    if (defects.empty()) return;
    if (const std::size_t repeated = count_duplicates(triangles()))
      add(counted(repeated, "triangle is", "triangles are") + " listed more than once");
    refuse(defects, mesh_.name, advice());
  }

  // Returns what makes this mesh pass; nothing in a trial, which asks only whether it passes.
  std::string advice() const {
    if (is_trial_) return "";
    return repair_advice({result_.solid, topology_, options_, diagonal_, scale_},
                         [this](const SolidOptions& options) {
                           const MeshProgress silent;
                           Check trial(mesh_, options, silent);
                           trial.is_trial_ = true;
                           return trial.run();
                         });
  }

  void orient() {
    std::size_t shell_count = 0;
    const std::vector<std::uint32_t> shell = shells_of(topology_, shell_count);
    const std::vector<Triangle> given = triangles();
    const bool consistent = topology_.conflicting.empty();
    if (!consistent && orient_consistently(topology_, triangles()) == kNotOrientable) {
      refuse("the surface is one-sided (like a Klein bottle); it has no inside", mesh_.name);
    }
    const ShellOrientation done = orient_shells(vertices(), shell, shell_count, consistent,
                                                triangles(), progress_of(0, kShellsDone));
    facts().shells = shell_count;
    facts().cavities = done.cavities;
    for (std::size_t k = 0; k < given.size(); ++k)
      facts().turned_triangles += given[k] != triangles()[k];
    note_orientation(consistent, done, shell_count);
  }

  void note_orientation(bool consistent, const ShellOrientation& done, std::size_t shell_count) {
    if (!consistent) {
      note(counted(topology_.conflicting.size(), "edge", "edges") +
           " had neighbours of opposite orientation; " +
           counted(facts().turned_triangles, "triangle was", "triangles were") +
           " turned to face outward");
    } else if (done.turned > 0) {
      note("the mesh faced inward and was turned" +
           (shell_count == 1 ? ""
                             : ": " + std::to_string(done.turned) + " of " +
                                   std::to_string(shell_count) + " shells"));
    }
  }

  void look_for_self_intersections() {
    for (const Triangle& t : triangles()) {
      facts().zero_area_triangles +=
          !has_area(vertices()[t[0]], vertices()[t[1]], vertices()[t[2]]);
    }
    contacts_ = find_contacts(vertices(), triangles(), progress_of(kShellsDone, kContactsDone));
    if (contacts_.empty()) return;
    const std::vector<TrianglePair> pairs = intersecting(contacts_, vertices(), triangles());
    facts().self_intersections = pairs.size();
    if (pairs.empty()) return;
    std::vector<std::uint32_t> first;
    for (const TrianglePair& pair : pairs) {
      if (first.empty() || first.back() != pair.first) first.push_back(pair.first);
    }
    const auto place = [&](std::uint32_t triangle) {
      const Triangle& t = triangles()[triangle];
      // Uses the file's unit.
      return text_of((vertices()[t[0]] + vertices()[t[1]] + vertices()[t[2]]) / (3 * scale_));
    };
    warn("the mesh intersects itself: " + counted(pairs.size(), "pair", "pairs") + " of triangles" +
         first_place(first, place) +
         "; what it encloses at least once is the solid, and overlaps count once");
  }

  // Drops shells wholly within the solid, which would only be obstacles for the spheres.
  void drop_inner_shells() {
    if (contacts_.empty() && facts().shells == 1) {  // all of it bounds the solid
      facts().volume = result_.enclosure.volume = mass_properties(result_.solid).volume;
      if (progress_) progress_(1);
      return;
    }
    const OuterSurface outer(result_.solid, contacts_, progress_of(kContactsDone, 1));
    std::size_t shell_count = 0;
    const std::vector<std::uint32_t> shell = shells_of(topology_, shell_count);
    std::vector<char> bounds(shell_count, 0);
    for (std::uint32_t t = 0; t < triangles().size(); ++t) {
      if (!outer.bounds_nothing(t)) bounds[shell[t]] = 1;
    }
    result_.enclosure = enclosure_of(outer);
    facts().volume = result_.enclosure.volume;
    const auto inner = static_cast<std::size_t>(std::count(bounds.begin(), bounds.end(), 0));
    if (inner == 0 || inner == shell_count) return;
    facts().inner_shells = inner;
    note(
        counted(facts().inner_shells, "shell", "shells") +
        " inside of the solid dropped: nothing but solid lies on both sides; turn it over if it is "
        "a cavity");
    std::vector<Triangle> kept;
    for (std::uint32_t t = 0; t < triangles().size(); ++t) {
      if (bounds[shell[t]] != 0) kept.push_back(triangles()[t]);
    }
    triangles() = std::move(kept);
    drop_unused(vertices(), triangles());
    if (contacts_.empty()) result_.enclosure.surface.reset();  // equals the remaining solid
    facts().shells -= facts().inner_shells;
  }

  void measure() {
    const Box box = box_of(vertices(), triangles());
    facts().low = box.low;
    facts().high = box.high;
    facts().vertices = vertices().size();
    facts().triangles = triangles().size();
    // A closed mesh has three edges per two triangles.
    facts().euler = static_cast<std::int64_t>(vertices().size()) -
                    static_cast<std::int64_t>(triangles().size() / 2);
    facts().area = area_of(result_.solid);
    if (!(facts().volume > kFlat * facts().area * norm(box.high - box.low))) {
      char text[96];
      std::snprintf(text, sizeof text,
                    "the mesh is degenerate: it is closed, but encloses no volume (%.3g m^3)",
                    facts().volume);
      refuse(text, mesh_.name);
    }
    warn_of_size();
  }

  // Warns of sizes that few tools have, with the scale that is likely meant. Grippers and links of
  // robots are .005 to 3 m long; in millimetres these are 5 to 3000 "m".
  void warn_of_size() {
    constexpr double kLargest = 5, kLargestOfToldScale = 100, kSmallest = 0.001;  // m
    const Vec3 sides = facts().high - facts().low;
    const double size = std::max({sides.x, sides.y, sides.z});
    if (size >= kSmallest && size < (options_.scale ? kLargestOfToldScale : kLargest)) return;
    const bool is_large = size > kSmallest, is_of_millimetres = mesh_.metres_per_unit == 0.001;
    const char* const cause =
        !is_large           ? ": if it was scaled to metres twice"
        : is_of_millimetres ? " by the unit of its file: if it was scaled to millimetres twice"
        : mesh_.format == MeshFormat::gltf
            ? ", as glTF's unit is the metre: if its program wrote millimetres"
        : has_unit(mesh_.format) ? " by the unit of its file: if that should be the millimetre"
                                 : ": if its unit is the millimetre";
    char text[200];
    std::snprintf(text, sizeof text, "the mesh is %.3g m across%s, give `scale` %g", size, cause,
                  scale_ * (!is_large           ? 1000
                            : is_of_millimetres ? 0.001
                                                : 0.001 / mesh_.metres_per_unit));
    warn(text);
  }

  // Shares of the progress after two of the steps that may take long.
  static constexpr double kShellsDone = 0.2, kContactsDone = 0.5;

  // Returns what shows the progress of a step that takes these fractions of all.
  MeshProgress progress_of(double from, double to) const {
    if (!progress_) return {};
    return [this, from, to](double done) { progress_(from + done * (to - from)); };
  }

  void note(const std::string& text) { result_.notes.push_back(text); }
  void warn(const std::string& text) { result_.warnings.push_back(text); }

  const RawMesh& mesh_;
  const SolidOptions& options_;
  const double scale_ = options_.scale.value_or(1);
  const MeshProgress& progress_;
  bool is_trial_ = false;  // asks only whether the mesh passes
  CheckedSolid result_;
  Topology topology_;
  std::vector<TrianglePair> contacts_;
  double diagonal_ = 0;
  double unit_ = 1;  // unit of the vertices, in the file's
};

}  // namespace

CheckedSolid make_solid(const RawMesh& mesh, const SolidOptions& options,
                        const MeshProgress& progress) {
  if (const double scale = options.scale.value_or(1); !(scale > 0 && std::isfinite(scale)))
    throw Error(ErrorKind::invalid_argument, "must be a positive number", "scale");
  if (options.max_hole && !(*options.max_hole > 0))
    throw Error(ErrorKind::invalid_argument, "must be a positive number", "max-hole");
  if (options.weld && !(*options.weld >= 0 && *options.weld <= kLargestWeld)) {
    throw Error(ErrorKind::invalid_argument,
                "must lie between 0 and 0.1; it is a share of the mesh's diagonal", "weld");
  }
  const std::string coarse = coarse_coordinates(mesh);
  try {
    CheckedSolid checked = Check(mesh, options, progress).run();
    if (!coarse.empty()) checked.warnings.push_back(coarse + "; " + kMoveToOrigin);
    return checked;
  } catch (const Error& fault) {
    if (fault.kind() != ErrorKind::refused || (coarse.empty() && mesh.doubt.empty())) throw;
    const std::string cause = mesh.doubt.empty() ? coarse : mesh.doubt;
    refuse(cause + "; so " + fault.problem(), fault.where(),
           mesh.doubt.empty() ? kMoveToOrigin : "save it again, or fetch all of it");
  }
}

}  // namespace vpm
