#include "tests/fuzz/query_check.h"

#include <array>
#include <cmath>

#include "libvpm/cloud/cloud.h"
#include "libvpm/model/tool_model.h"
#include "libvpm/query/tool_query.h"
#include "libvpm/scene/any_body.h"

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

QueryOptions options_of(std::size_t way, bool tells_inside) {
  QueryOptions options;
  options.measure = way == 1 ? Measure::paper : Measure::refined;
  if (way == 2 && tells_inside) options.shadows = Shadows::solid;
  options.coherent = way == 3;
  return options;
}

// Asks before the cloud or where its middle is.
void expect_sound_answers(const ToolModel& tool, const AnyBody& cloud, Choice choice) {
  Pose pose{{}, {0, 0, 1}};
  if (choice.one_of(2) == 1 && !cloud.positions().empty()) {
    const Vec3 middle = cloud.origin() + widen(cloud.positions()[cloud.positions().size() / 2]);
    pose.translation = middle - tool.center_of_mass;
  }
  const std::size_t way = choice.one_of(4);
  ToolQuery query(tool, options_of(way, cloud.tells_inside()));
  expect_sound(query.run(cloud, pose));
  if (way == 3) expect_sound(query.run(cloud, pose));
}

}  // namespace

void expect_sound_answers(const Cloud& cloud, Choice choice) {
  static const ToolModel cube = read_tool_model(kGolden + "cube.vpmg");
  if (cloud.positions.size() > kMostPoints) return;
  if (cloud.sensor) {
    const Camera& camera = cloud.sensor->camera;
    if (std::size_t{camera.width} * camera.height > kMostPixels) return;
  }
  const AnyBody prepared(cloud, choice.one_of(2) == 0 ? Denoising::on : Denoising::off);
  expect_sound_answers(cube, prepared, choice);
}

void expect_sound_answers(const ToolModel& tool, Choice choice) {
  static const AnyBody wall(read_cloud(kGolden + "wall.vpmc")),
      scattered(read_cloud(kGolden + "scattered.vpmc"));
  expect_sound_answers(tool, choice.one_of(2) == 0 ? wall : scattered, choice);
}

}  // namespace vpm::fuzz
