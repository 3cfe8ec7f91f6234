#include "tools/bench/intervals.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <span>
#include <string>

#include "libvpm/query/tool_query.h"
#include "tools/bench/errors.h"
#include "tools/bench/random_poses.h"
#include "tools/bench/suite.h"
#include "tools/bench/view.h"

namespace vpm::bench {
namespace {

constexpr std::uint64_t kPoseSeed = 31;
constexpr double kLeastInside = 1e-4;     // of the tool
constexpr double kTruthTolerance = 1e-5;  // of the tool's volume: a fiftieth of an interval
// Parts of the truths that intervals must hold: of all, and of each scene seen in one way.
constexpr double kLeastOfAll = 0.93, kMostOfAll = 0.995, kLeastOfEach = 0.88;

const std::vector<std::string> kScenes{"tilted-wall", "inverted-ball", "ball",
                                       "groove",      "step",          "plate"};

struct Coverage {
  int poses = 0, inside = 0;  // asked, and those whose truth lies in the interval
  double widths = 0;          // sum of the intervals' widths, in parts of the tool's volume
  double errors = 0;          // sum of the volumes' errors, likewise

  double covered() const { return static_cast<double>(inside) / poses; }
};

// Adds poses in one view to the coverage.
class CoverageOfView {
 public:
  CoverageOfView(const synthetic::Scene& scene, const View& view,
                 const std::vector<const PackedSolid*>& tools, std::uint32_t level)
      : scene_(scene), view_(view), tools_(tools) {
    for (const Camera& camera : view.cameras) sights_.emplace_back(*scene.surface, camera);
    for (const PackedSolid* tool : tools)
      queries_.emplace_back(tool->model, QueryOptions{.level = level, .interval = true});
  }

  // Goes on with the random poses after those that were `tried`.
  void add(int poses, std::uint64_t& tried, Coverage& coverage) {
    for (const int last = coverage.poses + poses; coverage.poses < last;) {
      const std::size_t k = tried % tools_.size();
      const synthetic::TrueSolid& solid = tools_[k]->solid;
      const Pose pose = random_pose(kPoseSeed, tried++, solid.radius());
      const double truth = solid.penetration(pose, *scene_.surface, kTruthTolerance).volume;
      if (truth >= kLeastInside * solid.mass().volume && truth <= kFullest * solid.mass().volume)
        add(k, pose, truth, coverage);
    }
  }

 private:
  void add(std::size_t k, const Pose& pose, double truth, Coverage& coverage) {
    const PackedSolid& tool = *tools_[k];
    const double whole = tool.solid.mass().volume, part = truth / whole;
    const Result result = queries_[k].run(view_.cloud, pose);
    const Interval interval = result.volume_interval.value();
    const auto holds = [&](const Unseen& unseen) {
      return interval.low <= (part + unseen.free) * whole &&
             interval.high >= (part - unseen.inside) * whole;
    };
    // What no camera can know takes long to count, and matters only where the truth is outside.
    const auto places =
        std::span(tool.places).first(std::min(kPlacesOfIntervals, tool.places.size()));
    const Unseen unseen =
        holds({}) ? Unseen{} : unseen_parts(places, pose, *scene_.surface, sights_);
    ++coverage.poses;
    coverage.inside += holds(unseen);
    coverage.widths += (interval.high - interval.low) / whole;
    coverage.errors += volume_error(result.volume / whole, part, unseen);
  }

  const synthetic::Scene& scene_;
  const View& view_;
  const std::vector<const PackedSolid*>& tools_;
  std::vector<Sight> sights_;
  std::deque<ToolQuery> queries_;
};

Coverage coverage_of(const synthetic::Scene& scene, CloudKind kind, Noise noise,
                     const std::vector<const PackedSolid*>& tools, std::uint32_t level, int poses,
                     int images) {
  Coverage coverage;
  std::uint64_t tried = 0;
  const int views = noise == Noise::none ? 1 : images;
  for (int k = 0; k < views; ++k) {
    // The cameras of one view take seeds that follow each other.
    const View view = make_view(scene, kind, noise, kNoiseSeed + 2 * static_cast<unsigned>(k));
    CoverageOfView(scene, view, tools, level)
        .add(poses * (k + 1) / views - coverage.poses, tried, coverage);
  }
  return coverage;
}

void check(const std::string& what, double value, double bound, Report& report) {
  report.settings["bounds"].push_back(
      {{"what", what}, {"value", value}, {"bound", bound}, {"holds", value <= bound}});
}

std::string text_of(const std::string& scene, const std::string& cloud, const std::string& noise,
                    const Coverage& of) {
  char line[120];
  std::snprintf(line, sizeof line, "%-13s %-7s %-7s %6d %9.1f %% %9.3f %9.3f\n", scene.c_str(),
                cloud.c_str(), noise.c_str(), of.poses, 100 * of.covered(),
                100 * of.widths / of.poses, 100 * of.errors / of.poses);
  return line;
}

}  // namespace

void add_intervals(const std::vector<const PackedSolid*>& tools, std::uint32_t level, int poses,
                   int images, Report& report) {
  report.summary +=
      "\nIntervals of 95 %: truths inside; mean width and mean error, % of the tool\n"
      "scene         cloud   noise    poses     inside     width     error\n";
  Coverage all;
  double least = 1;
  for (const std::string& name : kScenes) {
    const synthetic::Scene scene = synthetic::make_scene(name);
    for (const CloudKind kind : {CloudKind::camera, CloudKind::points}) {
      // One camera does not see the back of a plate: a count of places bounds the truth too
      // roughly.
      if (name == "plate" && kind == CloudKind::camera) continue;
      for (const Noise noise : {Noise::none, Noise::kinect}) {
        const Coverage of = coverage_of(scene, kind, noise, tools, level, poses, images);
        report.results.push_back({{"group", "intervals"},
                                  {"scene", name},
                                  {"cloud", to_text(kind)},
                                  {"noise", to_text(noise)},
                                  {"spheres", level},
                                  {"poses", of.poses},
                                  {"inside", of.covered()},
                                  {"width_mean", of.widths / of.poses},
                                  {"volume_mean", of.errors / of.poses}});
        report.summary += text_of(name, to_text(kind), to_text(noise), of);
        all.poses += of.poses, all.inside += of.inside;
        all.widths += of.widths, all.errors += of.errors;
        least = std::min(least, of.covered());
      }
    }
  }
  report.summary += text_of("all", "", "", all);
  check("truths outside of their intervals", 1 - all.covered(), 1 - kLeastOfAll, report);
  check("truths inside of their intervals", all.covered(), kMostOfAll, report);
  check("truths outside, in the scene and view with most", 1 - least, 1 - kLeastOfEach, report);
}

}  // namespace vpm::bench
