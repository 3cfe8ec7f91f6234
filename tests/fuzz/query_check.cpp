#include "tests/fuzz/query_check.h"

#include <array>
#include <cmath>

#include "libvpm/cloud/cloud.h"
#include "libvpm/model/tool_model.h"
#include "libvpm/query/tool_query.h"
#include "tests/fuzz/fuzz_target.h"

namespace vpm::fuzz {
namespace {

const std::string kGolden = VPM_SOURCE_DIR "/formats/golden/v1/";
constexpr std::size_t kMostPoints = 20'000, kMostPixels = 50'000;

void expect_sound(const Result& result) {
  constexpr double kRounding = 1e-5;
  if (!std::isfinite(result.volume) || !std::isfinite(result.volume_fraction))
    fail("a volume is not finite");
  if (!is_finite(result.wrench.force) || !is_finite(result.wrench.torque))
    fail("a wrench is not finite");
  if (result.volume_fraction < -kRounding || result.volume_fraction > 1 + kRounding)
    fail("a fraction of " + std::to_string(result.volume_fraction));
}

QueryOptions options_of(int way, bool is_organised) {
  QueryOptions options;
  options.measure = way == 1 ? Measure::paper : Measure::refined;
  options.counts_points = way == 2;
  if (way == 2 && is_organised) options.occluded = OccludedSpace::solid;
  options.coherent = way == 3;
  return options;
}

Vec3 middle_of(const PreparedCloud& cloud) {
  return cloud.origin() + widen(cloud.positions()[cloud.positions().size() / 2]);
}

}  // namespace

void expect_sound_answers(const ToolModel& tool, const PreparedCloud& cloud, const Pose& pose) {
  for (int way = 0; way < 4; ++way) {
    expect_error_at_most([&] {
      ToolQuery query(tool, options_of(way, cloud.is_organised()));
      const Result first = query.run(cloud, pose);
      expect_sound(first);
      if (way == 3) expect_sound(query.run(cloud, pose));
    });
  }
}

void expect_sound_answers(const Cloud& cloud) {
  static const ToolModel cube = read_tool_model(kGolden + "cube.vpmg");
  if (cloud.positions.size() > kMostPoints) return;
  if (cloud.sensor) {
    const Camera& camera = cloud.sensor->camera;
    if (std::size_t{camera.width} * camera.height > kMostPixels) return;
  }
  for (const Denoising denoising : {Denoising::on, Denoising::off}) {
    expect_error_at_most([&] {
      const PreparedCloud prepared(cloud, denoising);
      expect_sound_answers(cube, prepared, {{}, {0, 0, 1}});
      if (!prepared.positions().empty())
        expect_sound_answers(cube, prepared, {{}, middle_of(prepared) - cube.center_of_mass});
    });
  }
}

void expect_sound_answers(const ToolModel& tool) {
  static const PreparedCloud wall(read_cloud(kGolden + "wall.vpmc")),
      scattered(read_cloud(kGolden + "scattered.vpmc"));
  for (const PreparedCloud* cloud : {&wall, &scattered}) {
    expect_sound_answers(tool, *cloud, {{}, {0, 0, 1}});
    expect_sound_answers(tool, *cloud, {{}, middle_of(*cloud) - tool.center_of_mass});
  }
}

}  // namespace vpm::fuzz
