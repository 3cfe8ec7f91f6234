#include <cmath>
#include <limits>

#include "libvpm/graph/build_tool_model.h"
#include "libvpm/synthetic/shapes.h"
#include "libvpm/synthetic/truth.h"
#include "tools/bench/extremes.h"
#include "tools/bench/penetration_case.h"

namespace vpm::bench {
namespace {

Cloud floor_at(double z) {
  return plane_points({narrow({0, 0, z})}, {{0, 0, 1}});
}

// Compares the refined volume with the exact one at a plane z = height.
Deviation at_floor(const Device& device, const Packing& packing, double height, double bound) {
  const ToolModel tool = build_tool_model(packing, {});
  validate(tool, "tool");
  const synthetic::SurfacePtr floor = synthetic::make_wall({0, 0, height}, {0, 0, 1});
  const double truth =
      synthetic::TrueSolid(packing.solid).penetration({}, *floor).volume / tool.volume;
  if (std::isnan(ask(device, tool, floor_at(height), Measure::paper)))
    return {std::numeric_limits<double>::quiet_NaN(), truth, bound};
  return {ask(device, tool, floor_at(height), Measure::refined), truth, bound};
}

Packing two_spheres() {
  Packing packing;
  packing.solid = synthetic::make_box(2, 2, 4);
  packing.spheres = {{{0, 0, -1}, 1}, {{0, 0, 1}, 1}};
  return packing;
}

// Returns a row of spheres of radius 1, 0.1 ... 1e-6, each beside the one before, in a box.
Packing radii_over_six_decades() {
  Packing packing;
  packing.solid = synthetic::make_box(2.5, 2, 2);
  double x = -1.25;
  for (double radius = 1; radius > 0.9e-6; radius /= 10) {
    packing.spheres.push_back({{x + radius, 0, 0}, radius});
    x += 2 * radius;
  }
  return packing;
}

// Places a point in the smallest sphere's centre. Half of that sphere is inside, 1e-19 of the tool
// and below what the sums resolve.
Deviation touch_of_the_smallest() {
  const Packing packing = radii_over_six_decades();
  const ToolModel tool = build_tool_model(packing, {});
  const Sphere& smallest = packing.spheres.back();
  Cloud cloud = plane_points({{}}, {{0, 0, 1}});
  cloud.origin = smallest.center;
  ToolQuery query(tool, {.measure = Measure::paper});
  const Result r = query.run(AnyBody(cloud), {});
  if (r.boundary != 1) return {std::numeric_limits<double>::quiet_NaN(), 0, 0};
  constexpr double kResolution = 0x1p-60;
  return {sound_fraction(r), volume(smallest) / 2 / tool.volume, kResolution};
}

// Packs a long or flat tool and tilts it into a wall that a camera sees.
Deviation packed_into_wall(const Device& device, const Solid& solid, std::uint32_t spheres,
                           double bound) {
  const ToolModel tool = make_tool(solid, {spheres});
  const synthetic::SurfacePtr wall = synthetic::make_wall({0, 0, 1}, {0, 0, -1});
  const Cloud cloud = see(*wall, small_camera());
  const synthetic::TrueSolid truth(solid);
  const Rotation turned = rotation_from_quaternion({0.18, -0.37, 0.29, std::sqrt(1 - 0.2534)});
  double worst = 0;
  for (const double z : {0.95, 1.0, 1.02}) {
    const Pose pose{turned, {0.013, -0.021, z}};
    const double part = truth.penetration(pose, *wall).volume / tool.volume;
    const double error = std::abs(ask(device, tool, cloud, Measure::refined, pose) - part);
    if (!(error <= worst)) worst = error;
  }
  return {worst, 0, bound};
}

void add_tools(std::vector<ExtremeCase>& cases, const Device& device, bool quick) {
  const auto add = [&](const std::string& name, const std::function<Deviation()>& run) {
    cases.push_back({"tools", name, false, run});
  };
  add("one sphere", [=] { return at_floor(device, lattice_packing(1), 0.1, 0.02); });
  add("two spheres", [=] { return at_floor(device, two_spheres(), 0.3, 0.02); });
  const int edge = quick ? 10 : 100;
  add(quick ? "1000 spheres" : "a million spheres",
      [=] { return at_floor(device, lattice_packing(edge), 0.123, 2e-3); });
  add("radii from 1 to 1e-6",
      [=] { return at_floor(device, radii_over_six_decades(), -0.2, 0.01); });
  add("radii from 1 to 1e-6, the smallest touched", [] { return touch_of_the_smallest(); });
  const std::uint32_t spheres = quick ? 60 : 2000;
  add("needle 1:1000", [=] {
    return packed_into_wall(device, synthetic::make_box(0.2, 0.0002, 0.0002), spheres, 0.01);
  });
  add("sheet 1:1000", [=] {
    return packed_into_wall(device, synthetic::make_box(0.2, 0.2, 0.0002), spheres, 0.01);
  });
}

// The tool of two by two by two spheres.
const ToolModel& small_tool() {
  static const ToolModel tool = build_tool_model(lattice_packing(2), {});
  return tool;
}

void add_refused_models(std::vector<ExtremeCase>& cases) {
  const auto add = [&](const std::string& name, void (*spoil)(ToolModel&)) {
    cases.push_back({"sums", name, true, [=] {
                       ToolModel tool = small_tool();
                       spoil(tool);
                       validate(tool, "tool");
                       return Deviation{};
                     }});
  };
  add("spheres that hold more than the tool", [](ToolModel& t) { t.volume /= 4; });
  add("weights that sum to more than 1",
      [](ToolModel& t) { t.levels[0].samples[0].weight += 0.01; });
  add("shares that sum to less than the tool",
      [](ToolModel& t) { t.levels[0].cell_volume[0] *= 0.9; });
  add("a sample beyond the tool", [](ToolModel& t) { t.levels[0].samples[0].center.x = 100; });
  add("a tool without reach", [](ToolModel& t) { t.radius = 0; });
  add("more samples in a share than are counted exactly", [](ToolModel& t) {
    constexpr std::uint32_t kMore = 1u << 20;
    Level& level = t.levels[0];
    level.samples.insert(level.samples.begin(), kMore, CellSample{{}, 0.1f, 0});
    for (CellBlock& block : level.blocks) block.begin += kMore, block.end += kMore;
    level.blocks[0].begin = 0;
  });
}

void add_poses(std::vector<ExtremeCase>& cases, const Device& device) {
  const auto add = [&](const std::string& name, const std::function<Pose()>& make, bool refused) {
    cases.push_back(
        {"poses", name, refused, [=] {
           const ToolModel& tool = small_tool();
           const double camera =
               ask(device, tool, see(*synthetic::make_wall({0, 0, 9}, {0, 0, -1}), small_camera()),
                   Measure::refined, make());
           const double points = ask(device, tool, floor_at(-1e3), Measure::paper, make());
           return Deviation{camera + points, 0, 0};
         }});
  };
  const auto text = [](const char* t) { return [t] { return pose_from_text(t); }; };
  add("10^15 m away", text("1e15,-1e15,1e15,0,0,0,1"), false);
  add("10^30 m away", text("0,-1e30,-1e30,0,0,0,1"), false);
  add("10^300 m away", text("1e300,0,0,0,0,0,1"), true);
  add("translation not a number", text("nan,0,0,0,0,0,1"), true);
  add("quaternion zero", text("0,0,0,0,0,0,0"), true);
  add("quaternion denormal", text("0,0,0,1e-310,0,0,1e-310"), true);
  add("quaternion not a number", text("0,0,0,nan,0,0,1"), true);
  add("quaternion huge", text("0,0,0,1e200,0,0,0"), true);
  add(
      "matrix that mirrors",
      [] {
        return Pose{rotation_from_matrix({-1, 0, 0, 0, 1, 0, 0, 0, 1}), {}};
      },
      true);
  add(
      "mirror given past the parser",
      [] {
        return Pose{{{-1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {}};
      },
      true);
}

}  // namespace

std::vector<ExtremeCase> extreme_tools(const Device& device, bool quick) {
  std::vector<ExtremeCase> cases;
  add_tools(cases, device, quick);
  add_refused_models(cases);
  add_poses(cases, device);
  return cases;
}

}  // namespace vpm::bench
