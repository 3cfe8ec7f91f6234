// The same queries in double and in single precision by turns: times and differences, as JSON.
// compare TOOL.vpmg CLOUD.vpmc POSES.jsonl LEVELS
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "libvpm/cloud/cloud_file.h"
#include "libvpm/core/parallel.h"
#include "libvpm/model/tool_model_file.h"
#include "libvpm/query/query.h"
#include "libvpm_single/core/parallel.h"
#include "libvpm_single/query/query.h"
#include "tools/bench/statistics.h"

namespace single = vpm_single;
using nlohmann::json;

namespace vpm_single {
// Frames of depth images are not compared.
const PreparedCloud& DepthFrame::cloud() const {
  std::abort();
}
}  // namespace vpm_single

namespace {

single::Vec3 to_single(vpm::Vec3 v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}
single::Vec3f to_single(vpm::Vec3f v) {
  return {v.x, v.y, v.z};
}
float to_single(double x) {
  return static_cast<float>(x);
}
single::Sphere to_single(const vpm::Sphere& s) {
  return {to_single(s.center), to_single(s.radius)};
}
single::Pose to_single(const vpm::Pose& p) {
  return {{to_single(p.rotation.row0), to_single(p.rotation.row1), to_single(p.rotation.row2)},
          to_single(p.translation)};
}
single::CellBlock to_single(const vpm::CellBlock& b) {
  return {to_single(b.center), b.radius, b.begin, b.end};
}
single::CellSample to_single(const vpm::CellSample& s) {
  return {to_single(s.center), s.radius, to_single(s.weight)};
}
single::HierarchyNode to_single(const vpm::HierarchyNode& n) {
  return {to_single(n.bound), n.begin, n.end, n.children_are_leaves, 0};
}
template <class From, class To>
void to_single(const std::vector<From>& from, std::vector<To>& to) {
  for (const From& value : from) to.push_back(to_single(value));
}

single::Level to_single(const vpm::Level& from) {
  single::Level to;
  to.epsilon = to_single(from.epsilon);
  to.bridges = from.bridges, to.components_before = from.components_before,
  to.sphere_count = from.sphere_count;
  to.graph = {from.graph.begin, from.graph.neighbors};
  to_single(from.hierarchy.nodes, to.hierarchy.nodes);
  to.hierarchy.leaves = from.hierarchy.leaves;
  to.grid = {
      to_single(from.grid.low), to_single(from.grid.cell), from.grid.nx, from.grid.ny, from.grid.nz,
      from.grid.begin,          from.grid.spheres};
  to_single(from.share_volume, to.share_volume);
  to_single(from.share_centroid, to.share_centroid);
  to_single(from.share_reach, to.share_reach);
  to.block_begin = from.block_begin;
  to_single(from.blocks, to.blocks);
  to_single(from.samples, to.samples);
  return to;
}

single::ToolModel to_single(const vpm::ToolModel& from) {
  single::ToolModel to;
  to.volume = to_single(from.volume), to.reach = to_single(from.reach);
  to.center_of_mass = to_single(from.center_of_mass);
  to.solid_hash = from.solid_hash;
  to_single(from.spheres, to.spheres);
  for (const vpm::Level& level : from.levels) to.levels.push_back(to_single(level));
  return to;
}

single::Cloud to_single(const vpm::Cloud& from) {
  single::Cloud to;
  to.origin = to_single(from.origin);
  to_single(from.positions, to.positions);
  to_single(from.normals, to.normals);
  to.radii = from.radii, to.pixels = from.pixels;
  if (from.sensor) {
    const vpm::Camera& camera = from.sensor->camera;
    const vpm::Intrinsics& k = camera.intrinsics;
    const vpm::DepthImage& depth = from.sensor->depth;
    to.sensor =
        single::CloudSensor{{{to_single(k.fx), to_single(k.fy), to_single(k.cx), to_single(k.cy)},
                             camera.width,
                             camera.height,
                             to_single(camera.to_world)},
                            {depth.width, depth.height, depth.depth}};
  }
  return to;
}

// As control-loop writes them: lines of [tx,ty,tz,qx,qy,qz,qw].
std::vector<vpm::Pose> read_poses(const char* path) {
  std::vector<vpm::Pose> poses;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    const auto p = json::parse(line).get<std::array<double, 7>>();
    poses.push_back({vpm::rotation_from_quaternion({p[3], p[4], p[5], p[6]}), {p[0], p[1], p[2]}});
  }
  return poses;
}

template <class Query, class Cloud, class Pose>
auto timed(Query& query, const Cloud& cloud, const Pose& pose, std::vector<double>& microseconds) {
  const auto begin = std::chrono::steady_clock::now();
  const auto result = query.run(cloud, pose);
  const std::chrono::duration<double, std::micro> taken = std::chrono::steady_clock::now() - begin;
  microseconds.push_back(taken.count());
  return result;
}

json to_json(const std::vector<double>& microseconds) {
  const vpm::bench::Spread s = vpm::bench::spread_of(microseconds);
  return {{"median_us", s.median}, {"quartile1_us", s.quartile1}, {"quartile3_us", s.quartile3}};
}

vpm::Vec3 widened(single::Vec3 v) {
  return {v.x, v.y, v.z};
}

json compare(const vpm::ToolModel& tool, const single::ToolModel& tool_single,
             const vpm::Cloud& cloud, const std::vector<vpm::Pose>& poses, std::uint32_t level) {
  const vpm::PreparedCloud prepared(cloud);
  const single::PreparedCloud prepared_single(to_single(cloud));
  vpm::Query query(tool, {.level = level, .counts_points = false});
  single::Query query_single(tool_single, {.level = level, .counts_points = false});
  query.run(prepared, poses[0]);
  query_single.run(prepared_single, to_single(poses[0]));
  std::vector<double> times, times_single;
  double volume = 0, force = 0, torque = 0;
  for (const vpm::Pose& pose : poses) {
    const vpm::Result a = timed(query, prepared, pose, times);
    const single::Result b = timed(query_single, prepared_single, to_single(pose), times_single);
    const vpm::Wrench& w = a.wrench;
    volume = std::max(volume, std::abs(a.volume_fraction - double{b.volume_fraction}));
    force = std::max(force, norm(w.force - widened(b.wrench.force)) / norm(w.force));
    torque = std::max(torque, norm(w.torque - widened(b.wrench.torque)) / (a.volume * tool.reach));
  }
  return {{"spheres", query.level().sphere_count},
          {"queries", poses.size()},
          {"double", to_json(times)},
          {"single", to_json(times_single)},
          {"volume_difference", volume},
          {"force_difference", force},
          {"torque_difference", torque}};
}

}  // namespace

int main(int, char** arguments) {
  const vpm::ToolModel tool = vpm::read_tool_model(arguments[1]);
  const single::ToolModel tool_single = to_single(tool);
  const vpm::Cloud cloud = vpm::read_cloud(arguments[2]);
  vpm::set_thread_count(1);
  single::set_thread_count(1);
  json results = json::array();
  const std::vector<vpm::Pose> poses = read_poses(arguments[3]);
  std::istringstream levels(arguments[4]);
  for (std::string level; std::getline(levels, level, ',');)
    results.push_back(
        compare(tool, tool_single, cloud, poses, static_cast<std::uint32_t>(std::stoul(level))));
  std::puts(results.dump(2).c_str());
}
