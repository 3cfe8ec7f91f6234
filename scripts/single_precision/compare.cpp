// The same queries in double and in single precision by turns, along a circle where a twentieth of
// the tool is inside: times and differences, as JSON. compare TOOL.vpmg CLOUD.vpmc LEVELS
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <sstream>

#include "libvpm/cloud/cloud_file.h"
#include "libvpm/core/parallel.h"
#include "libvpm/model/tool_model_file.h"
#include "libvpm/query/query.h"
#include "libvpm_single/core/parallel.h"
#include "libvpm_single/query/query.h"

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

// Poses about the place that the middle of an image shows.
class Circle {
 public:
  Circle(const vpm::ToolModel& tool, const vpm::PreparedCloud& cloud) : tool_(tool) {
    const std::size_t middle = cloud.positions().size() / 2 + cloud.positions().size() / 960;
    place_ = cloud.origin() + widen(cloud.positions()[middle]);
    towards_ = normalized_or_zero(cloud.camera_to_world().translation - place_);
    side_ = normalized_or_zero(cross(towards_, {1, 0, 0}));
  }
  vpm::Pose pose(double height, int step) const {
    constexpr double kRadius = 0.1;  // of the tool's reach
    const double phase = 0.025 * step, half = 0.15 * std::sin(0.005 * step), s = std::sin(half);
    const vpm::Rotation rotation = vpm::rotation_from_quaternion(
        {s * towards_.x, s * towards_.y, s * towards_.z, std::cos(half)});
    const vpm::Vec3 aside = kRadius * tool_.reach *
                            (std::sin(phase) * side_ + std::cos(phase) * cross(towards_, side_));
    return {rotation, place_ + height * towards_ + aside - rotation * tool_.center_of_mass};
  }

 private:
  const vpm::ToolModel& tool_;
  vpm::Vec3 place_, towards_, side_;
};

template <class Query, class Cloud, class Pose>
auto timed(Query& query, const Cloud& cloud, const Pose& pose, std::vector<double>& microseconds) {
  const auto begin = std::chrono::steady_clock::now();
  const auto result = query.run(cloud, pose);
  const std::chrono::duration<double, std::micro> taken = std::chrono::steady_clock::now() - begin;
  microseconds.push_back(taken.count());
  return result;
}

json spread(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const auto at = [&](double part) {
    return values[static_cast<std::size_t>(part * static_cast<double>(values.size() - 1))];
  };
  return {{"median_us", at(0.5)}, {"quartile1_us", at(0.25)}, {"quartile3_us", at(0.75)}};
}

vpm::Vec3 widened(single::Vec3 v) {
  return {v.x, v.y, v.z};
}

json compare(const vpm::ToolModel& tool, const single::ToolModel& tool_single,
             const vpm::Cloud& cloud, std::uint32_t level) {
  const vpm::PreparedCloud prepared(cloud);
  const single::PreparedCloud prepared_single(to_single(cloud));
  vpm::Query query(tool, {.level = level, .counts_points = false});
  single::Query query_single(tool_single, {.level = level, .counts_points = false});
  const Circle circle(tool, prepared);
  double low = -tool.reach, high = tool.reach;
  for (int k = 0; k < 24; ++k) {
    const double middle = 0.5 * (low + high);
    (query.run(prepared, circle.pose(middle, 0)).volume_fraction > 0.05 ? low : high) = middle;
  }
  constexpr int kWarmUp = 50, kSteps = 600;
  std::vector<double> times, times_single;
  double volume = 0, force = 0, torque = 0;
  for (int step = 0; step < kWarmUp + kSteps; ++step) {
    if (step == kWarmUp) times.clear(), times_single.clear();
    const vpm::Pose pose = circle.pose(low, step);
    const vpm::Result a = timed(query, prepared, pose, times);
    const single::Result b = timed(query_single, prepared_single, to_single(pose), times_single);
    const vpm::Wrench& w = a.wrench;
    volume = std::max(volume, std::abs(a.volume_fraction - double{b.volume_fraction}));
    force = std::max(force, norm(w.force - widened(b.wrench.force)) / norm(w.force));
    torque = std::max(torque, norm(w.torque - widened(b.wrench.torque)) / (a.volume * tool.reach));
  }
  return {{"spheres", query.level().sphere_count},
          {"queries", kSteps},
          {"double", spread(times)},
          {"single", spread(times_single)},
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
  std::istringstream levels(arguments[3]);
  for (std::string level; std::getline(levels, level, ',');)
    results.push_back(
        compare(tool, tool_single, cloud, static_cast<std::uint32_t>(std::stoul(level))));
  std::puts(results.dump(2).c_str());
}
