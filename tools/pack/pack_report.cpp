#include "tools/pack/pack_report.h"

#include <algorithm>

#include "libvpm/packing/fill_quality.h"

namespace vpm::tools {
namespace {

using nlohmann::json;

json as_json(Vec3 v) {
  return {v.x, v.y, v.z};
}

json as_json(const FilledHole& hole) {
  return {{"edges", hole.edges},
          {"center", as_json(hole.center)},
          {"size", hole.size},
          {"planar", hole.planar}};
}

json as_json(const VoxelRepair& repair) {
  return {{"voxel", repair.voxel},
          {"max_hole", repair.max_hole > 0 ? json(repair.max_hole) : json()},
          {"hausdorff_distance", std::max(repair.solid_to_mesh, repair.mesh_to_solid)},
          {"solid_to_mesh", repair.solid_to_mesh},
          {"mesh_to_solid", repair.mesh_to_solid}};
}

json as_json(const MeshFacts& facts) {
  json mesh = {{"format", name_of(facts.format)},
               {"vertices", facts.vertices},
               {"triangles", facts.triangles},
               {"shells", facts.shells},
               {"cavities", facts.cavities},
               {"euler_characteristic", facts.euler},
               {"area", facts.area},
               {"volume", facts.volume},
               {"box_low", as_json(facts.low)},
               {"box_high", as_json(facts.high)},
               {"inner_shells", facts.inner_shells},
               {"joined_vertices", facts.joined_vertices},
               {"unused_vertices", facts.unused_vertices},
               {"collapsed_triangles", facts.collapsed_triangles},
               {"turned_triangles", facts.turned_triangles},
               {"zero_area_triangles", facts.zero_area_triangles},
               {"self_intersections", facts.self_intersections},
               {"repeated_triangles", facts.repeated_triangles},
               {"filled_holes", json::array()}};
  for (const FilledHole& hole : facts.filled_holes) mesh["filled_holes"].push_back(as_json(hole));
  if (facts.voxel_repair) mesh["voxel_repair"] = as_json(*facts.voxel_repair);
  return mesh;
}

json as_json(const Validation& validation) {
  return {{"voxel", validation.voxel},
          {"volume_mesh", validation.volume_mesh},
          {"coverage", validation.coverage},
          {"coverage_error", validation.coverage_error},
          {"max_protrusion", validation.max_protrusion},
          {"max_overlap", validation.max_overlap},
          {"protruding_voxels", validation.protruding_voxels},
          {"overlapping_voxels", validation.overlapping_voxels},
          {"disputed_voxels", validation.disputed_voxels},
          {"detection_limit", validation.detection_limit}};
}

// Returns quality figures under the names that cuRobo's sphere fits use. Protrusion is 0: packings
// that protrude are refused before.
json quality(const CheckedSolid& checked, const PackResult& result) {
  const std::optional<Solid>& outer = checked.enclosure.surface;
  const SurfaceGap gap = surface_gap(outer ? *outer : checked.solid, result.spheres);
  return {{"coverage", result.coverage},      {"protrusion", 0},
          {"surface_gap_mean", gap.mean},     {"surface_gap_p95", gap.p95},
          {"max_uncovered_gap", gap.largest}, {"volume_ratio", result.coverage}};
}

}  // namespace

const char* name_of(StopReason reason) {
  switch (reason) {
    case StopReason::spheres:
      return "spheres";
    case StopReason::coverage:
      return "coverage";
    case StopReason::inertia_error:
      return "inertia_error";
    case StopReason::min_radius:
      return "min_radius";
    case StopReason::numerical_floor:
      return "numerical_floor";
  }
  return "";
}

double volume_of(const std::vector<Sphere>& spheres) {
  double sum = 0;
  for (const Sphere& s : spheres) sum += volume(s);
  return sum;
}

json pack_report(const CheckedSolid& checked, const PackResult& result,
                 const Certificate& certificate, const std::optional<Validation>& validation,
                 double seconds) {
  json report = {{"spheres", result.spheres.size()},
                 {"coverage", result.coverage},
                 {"coverage_bound", result.coverage_bound},
                 {"volume_mesh", checked.facts.volume},
                 {"volume_spheres", volume_of(result.spheres)},
                 {"max_protrusion", std::max(certificate.max_protrusion, 0.0)},
                 {"max_overlap", std::max(certificate.max_overlap, 0.0)},
                 {"certified", certificate.holds},
                 {"tolerance", certificate.tolerance},
                 {"r_min", result.spheres.back().radius},
                 {"r_max", result.spheres.front().radius},
                 {"stop_reason", name_of(result.stop)},
                 {"partly_searched", result.partly_searched},
                 {"seconds", seconds},
                 {"quality", quality(checked, result)},
                 {"mesh", as_json(checked.facts)},
                 {"notes", checked.notes},
                 {"warnings", checked.warnings}};
  InertiaError inertia(checked.solid);
  for (const Sphere& s : result.spheres) inertia.add(s);
  report["inertia_error"] = inertia.value();
  if (validation) report["validation"] = as_json(*validation);
  return report;
}

}  // namespace vpm::tools
