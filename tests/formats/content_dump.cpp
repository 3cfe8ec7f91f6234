#include "tests/formats/content_dump.h"

namespace vpm::golden {
namespace {

using nlohmann::json;

json of(Vec3 v) {
  return {v.x, v.y, v.z};
}
json of(Vec3f v) {
  return of(widen(v));
}
json of(const Triangle& t) {
  return {t[0], t[1], t[2]};
}
json of(const Sphere& s) {
  return {s.center.x, s.center.y, s.center.z, s.radius};
}
json of(const HierarchyNode& n) {
  return {{"bound", of(n.bound)},
          {"begin", n.begin},
          {"end", n.end},
          {"children_are_leaves", n.children_are_leaves}};
}
json of(const CellBlock& b) {
  return {
      {"center", of(b.center)}, {"radius", double{b.radius}}, {"begin", b.begin}, {"end", b.end}};
}
json of(const CellSample& s) {
  return {{"center", of(s.center)}, {"radius", double{s.radius}}, {"weight", s.weight}};
}

json of(const SampleFace& f) {
  return {{"sample", f.sample},     {"axis", of(f.axis)},       {"toward", double{f.toward}},
          {"away", double{f.away}}, {"along", double{f.along}}, {"across", double{f.across}}};
}

json of(const LevelError& e) {
  return {{"mean", e.mean}, {"p95", e.p95}, {"worst", e.worst}};
}

json of(const Level& level);

template <class T>
json list(const std::vector<T>& values) {
  json all = json::array();
  for (const T& value : values) all.push_back(of(value));
  return all;
}

json of(const Level& level) {
  const PointLocationGrid& grid = level.grid;
  json all{
      {"epsilon", level.epsilon},
      {"bridges", level.bridges},
      {"components_before", level.components_before},
      {"sphere_count", level.sphere_count},
      {"graph", {{"begin", level.graph.begin}, {"neighbors", level.graph.neighbors}}},
      {"hierarchy", {{"nodes", list(level.hierarchy.nodes)}, {"leaves", level.hierarchy.leaves}}},
      {"grid",
       {{"low", of(grid.low)},
        {"cell", grid.cell},
        {"size", {grid.nx, grid.ny, grid.nz}},
        {"begin", grid.begin},
        {"spheres", grid.spheres}}},
      {"share_volume", level.cell_volume},
      {"share_centroid", list(level.cell_centroid)},
      {"share_reach", level.cell_radius},
      {"block_begin", level.block_begin},
      {"blocks", list(level.blocks)},
      {"samples", list(level.samples)}};
  if (!level.faces.empty()) all["faces"] = list(level.faces);
  return all;
}

}  // namespace

json dump(const Packing& packing) {
  return {{"spheres", list(packing.spheres)},
          {"vertices", list(packing.solid.vertices)},
          {"triangles", list(packing.solid.triangles)},
          {"provenance", packing.provenance.json()}};
}

json dump(const ToolModel& model) {
  json all{{"volume", model.volume},
           {"center_of_mass", of(model.center_of_mass)},
           {"reach", model.radius},
           {"solid_hash", model.solid_hash},
           {"spheres", list(model.spheres)},
           {"levels", list(model.levels)},
           {"provenance", model.provenance.json()}};
  if (!model.calibration.empty()) all["calibration"] = list(model.calibration);
  if (!model.surface.triangles.empty())
    all["surface"] = {{"vertices", list(model.surface.vertices)},
                      {"triangles", list(model.surface.triangles)}};
  return all;
}

json dump(const Cloud& cloud) {
  json all{{"origin", of(cloud.origin)},
           {"positions", list(cloud.positions)},
           {"normals", list(cloud.normals)},
           {"radii", std::vector<double>(cloud.radii.begin(), cloud.radii.end())},
           {"provenance", cloud.provenance.json()}};
  if (cloud.sensor) {
    const auto& [camera, depth] = *cloud.sensor;
    const Rotation& r = camera.to_world.rotation;
    all["pixels"] = cloud.pixels;
    all["camera"] = {
        {"fx_fy_cx_cy",
         {camera.intrinsics.fx, camera.intrinsics.fy, camera.intrinsics.cx, camera.intrinsics.cy}},
        {"rotation", {of(r.row0), of(r.row1), of(r.row2)}},
        {"translation", of(camera.to_world.translation)},
        {"width", camera.width},
        {"height", camera.height}};
    all["depth"] = std::vector<double>(depth.depth.begin(), depth.depth.end());
  }
  return all;
}

}  // namespace vpm::golden
