// Measures what accuracy costs: everything that a user can turn, against time and error. Runs three
// tools in two scenes each, seen by a camera with and without noise. Each tool has one packing,
// whose prefixes are its levels.

#include <algorithm>
#include <chrono>
#include <map>
#include <tuple>

#include "libvpm/cloud/normals.h"
#include "libvpm/core/parallel.h"
#include "libvpm/graph/build_tool_model.h"
#include "libvpm/graph/calibration.h"
#include "libvpm/packing/packer.h"
#include "libvpm/query/level_tool_query.h"
#include "libvpm/query/scene_scale.h"
#include "libvpm/query/tool_query.h"
#include "libvpm/synthetic/render.h"
#include "tools/bench/errors.h"
#include "tools/bench/penetration_case.h"
#include "tools/bench/suite.h"
#include "tools/bench/tradeoff_report.h"
#include "tools/bench/view.h"

namespace vpm::bench {
namespace {

constexpr std::size_t kCountedPlaces =
    4096;                 // places of a tool that count what the camera cannot know
constexpr int kRuns = 3;  // runs of each query; the fastest counts, since load only slows
constexpr std::uint32_t kUsual = 1000;  // spheres while something else is varied

struct Case {
  std::string shape, scene;
  bool turned;
};

const std::vector<Case> kCases{{"cube", "wall", false},        {"cube", "inverted-ball", true},
                               {"octahedron", "ball", true},   {"octahedron", "groove", true},
                               {"torus", "tilted-wall", true}, {"torus", "ball", true}};

// Settings that make a cloud of a scene.
struct Sensing {
  Noise noise = Noise::none;
  NormalOptions normals;
  std::uint32_t stride = 1;

  auto key() const { return std::tuple(noise, normals.method, normals.window, stride); }
};

// Returns every stride-th pixel of every stride-th row, and adapts the camera.
DepthImage thinned(const DepthImage& image, Camera& camera, std::uint32_t stride) {
  if (stride == 1) return image;
  DepthImage thin{image.width / stride, image.height / stride, {}};
  for (std::uint32_t v = 0; v < thin.height; ++v)
    for (std::uint32_t u = 0; u < thin.width; ++u)
      thin.depth.push_back(image.depth[image.index(stride * u, stride * v)]);
  Intrinsics& k = camera.intrinsics;
  k = {k.fx / stride, k.fy / stride, k.cx / stride, k.cy / stride};
  camera.width = thin.width;
  camera.height = thin.height;
  return thin;
}

class Tradeoff {
 public:
  explicit Tradeoff(const SuiteOptions& options)
      : options_(options),
        levels_(options.quick ? std::vector<std::uint32_t>{30, 100, 300, kUsual}
                              : std::vector<std::uint32_t>{10, 30, 100, 300, kUsual, 3000, 10000,
                                                           30000, 100000}),
        cases_(kCases.begin(), kCases.begin() + (options.quick ? 2 : kCases.size())),
        poses_(options.quick ? 8 : 24) {}

  Report run() {
    vary_spheres();
    vary_sensing();
    if (!options_.device.is_cuda()) vary_threads();
    keep_max_error();
    keep_deadlines();
    fit_scenes();
    TradeoffSettings settings{options_.quick, levels_, poses_, cases_.size()};
    return tradeoff_report(settings, measured_, kept_, deadlines_, fitted_);
  }

 private:
  struct Tool {
    synthetic::TrueSolid solid;
    ToolModel model;
    std::vector<Vec3> places;
  };
  struct Run {
    std::vector<Pose> path;
    std::vector<synthetic::Penetration> truth;
    std::vector<Unseen> unseen;
  };

  const Tool& tool(const std::string& shape) {
    const auto found = tools_.find(shape);
    if (found != tools_.end()) return found->second;
    const Solid solid = make_shape(shape);
    ToolModel model = make_tool(solid, levels_);
    model.calibration = calibrate(model, solid);
    return tools_
        .try_emplace(shape, Tool{synthetic::TrueSolid(solid), std::move(model),
                                 places_in(solid, kCountedPlaces)})
        .first->second;
  }

  const Run& path(const Case& c) {
    const std::pair key(c.shape, c.scene);
    const auto found = runs_.find(key);
    if (found != runs_.end()) return found->second;
    const synthetic::Scene scene = synthetic::make_scene(c.scene);
    const Tool& t = tool(c.shape);
    const Rotation turned = rotation_from_quaternion({0.18, -0.37, 0.29, std::sqrt(1 - 0.2534)});
    Run run;
    run.path = make_sweep(t.solid, {c.turned ? turned : Rotation{}, {}}, *scene.surface, poses_);
    run.truth = truth_along(t.solid, run.path, *scene.surface);
    const std::vector<Sight> sights{{*scene.surface, scene.camera}};
    for (const Pose& pose : run.path)
      run.unseen.push_back(unseen_parts(t.places, pose, *scene.surface, sights));
    return runs_.try_emplace(key, std::move(run)).first->second;
  }

  const AnyBody& cloud(const std::string& name, const Sensing& sensing) {
    const auto key = std::tuple_cat(std::tuple(name), sensing.key());
    const auto found = clouds_.find(key);
    if (found != clouds_.end()) return found->second;
    const synthetic::Scene scene = synthetic::make_scene(name);
    Camera camera = scene.camera;
    const DepthImage depth =
        thinned(sensing.noise == Noise::none
                    ? synthetic::render(*scene.surface, camera)
                    : synthetic::render_with_kinect_noise(*scene.surface, camera, kNoiseSeed),
                camera, sensing.stride);
    return clouds_.try_emplace(key, make_cloud(depth, camera, sensing.normals)).first->second;
  }

  // Returns errors and the median over the poses of the fastest of kRuns.
  Errors measure(const Case& c, const ToolModel& model, const QueryOptions& query_options,
                 const Sensing& sensing, double& median_us) {
    const Run& run = path(c);
    const AnyBody& seen = cloud(c.scene, sensing);
    ToolQuery query(model, query_options);
    query.run(seen, run.path.back());  // allocates its memory
    std::vector<Result> results;
    std::vector<double> times;
    for (const Pose& pose : run.path) {
      double fastest = HUGE_VAL;
      Result result;
      for (int k = 0; k < kRuns; ++k) {
        const auto begin = std::chrono::steady_clock::now();
        result = query.run(seen, pose);
        const std::chrono::duration<double, std::micro> took =
            std::chrono::steady_clock::now() - begin;
        fastest = std::min(fastest, took.count());
      }
      results.push_back(result);
      times.push_back(fastest);
    }
    median_us = spread_of(times).median;
    return compare(results, run.truth, run.unseen, tool(c.shape).solid);
  }

  void vary(const std::string& what, std::uint32_t spheres, Measure measured_by,
            const Sensing& sensing, int usual_threads) {
    const ThreadCap cap(options_, usual_threads);
    for (const Case& c : cases_) {
      QueryOptions query_options;
      query_options.measure = measured_by;
      query_options.level = spheres;
      query_options.device = device_for(measured_by, options_.device);
      Measured m{what,
                 c.shape,
                 c.scene,
                 to_text(sensing.noise),
                 measured_by == Measure::paper ? "paper" : "refined",
                 to_text(sensing.normals.method),
                 sensing.normals.window,
                 static_cast<int>(sensing.stride),
                 thread_count(),
                 spheres,
                 0,
                 {}};
      m.errors = measure(c, tool(c.shape).model, query_options, sensing, m.median_us);
      measured_.push_back(m);
      if (options_.progress) options_.progress(std::min(0.99, 0.0013 * measured_.size()));
    }
  }

  static Sensing sensing(Noise noise) {
    Sensing s;
    s.noise = noise;
    return s;
  }

  void vary_spheres() {
    for (const Noise noise : {Noise::none, Noise::kinect})
      for (const Measure measured_by : {Measure::paper, Measure::refined})
        for (const std::uint32_t spheres : levels_)
          vary("spheres", spheres, measured_by, sensing(noise), 1);
  }

  void vary_sensing() {
    for (const NormalMethod method : {NormalMethod::inverse_depth, NormalMethod::pca}) {
      for (const int window : {5, 7, 11}) {
        Sensing s = sensing(Noise::kinect);
        s.normals.method = method;
        s.normals.window = window;
        vary("normals", kUsual, Measure::refined, s, 1);
      }
    }
    for (const Noise noise : {Noise::none, Noise::kinect}) {
      for (const std::uint32_t stride : {1u, 2u, 4u}) {
        Sensing s = sensing(noise);
        s.stride = stride;
        vary("stride", kUsual, Measure::refined, s, 1);
      }
    }
  }

  void vary_threads() {
    for (const std::uint32_t spheres : {kUsual, levels_.back()})
      for (const int threads : compared_threads(options_))
        vary("threads", spheres, Measure::refined, sensing(Noise::none), threads);
  }

  // Measures the errors of the level that --max-error chooses, in the tool's scenes.
  void keep_max_error() {
    for (const double asked : {0.05, 0.02, 0.01, 0.005, 0.002, 0.001}) {
      for (const auto& [shape, t] : tools_) {
        const LevelError& best = t.model.calibration.back();
        if (best.worst > asked) continue;
        const std::uint32_t spheres =
            t.model.levels[coarsest_level_within(t.model, asked)].sphere_count;
        Kept kept{shape, asked, spheres, 0, 0};
        for (const Measured& m : measured_) {
          if (m.varied != "spheres" || m.shape != shape || m.noise != "none" ||
              m.measure != "refined" || m.spheres != spheres)
            continue;
          kept.worst = std::max(kept.worst, m.errors.volume.worst());
          kept.mean = std::max(kept.mean, m.errors.volume.mean());
        }
        kept_.push_back(kept);
      }
    }
  }

  // Runs --deadline-us as vpm-query does, on one thread, along a path into the contact and out of
  // it by small steps, repeatedly.
  void keep_deadlines() {
    const std::size_t queries = options_.quick ? 500 : 10000;
    constexpr int kSteps = 250;
    const ThreadCap cap(options_, 1);
    for (const Case& c : cases_) {
      const synthetic::Scene scene = synthetic::make_scene(c.scene);
      const Tool& t = tool(c.shape);
      const Rotation turned = path(c).path.front().rotation;
      const std::vector<Pose> in = make_sweep(t.solid, {turned, {}}, *scene.surface, kSteps);
      const AnyBody& seen = cloud(c.scene, sensing(Noise::kinect));
      for (const double asked_us : {200.0, 1000.0}) {
        LevelRequest request;
        request.deadline_seconds = 1e-6 * asked_us;
        LevelToolQuery query(t.model, {.device = options_.device}, request, seen, in.front());
        Deadline d{c.shape, c.scene, to_text(Noise::kinect), asked_us, queries, 0, 0, 0};
        d.coarsest = t.model.levels.back().sphere_count;
        for (std::size_t k = 0; k < queries; ++k) {
          const std::size_t at = k % (2 * kSteps);
          query.run(seen, in[at < kSteps ? at : 2 * kSteps - 1 - at]);
          d.kept += query.seconds() <= *request.deadline_seconds;
          const std::uint32_t used = query.query().level().sphere_count;
          d.coarsest = std::min(d.coarsest, used);
          d.finest = std::max(d.finest, used);
        }
        deadlines_.push_back(d);
      }
    }
  }

  // Measures levels and packings by --for-scene beside the fixed sizes.
  void fit_scenes() {
    for (const Case& c : cases_) {
      for (const Noise noise : {Noise::none, Noise::kinect}) {
        const Tool& t = tool(c.shape);
        const AnyBody& seen = cloud(c.scene, sensing(noise));
        const Pose& deepest = path(c).path.back();
        Fitted f{c.shape, c.scene, to_text(noise), {}, 0, 0, {}, {}, 0, 0, {}};
        for (const Measured& m : measured_) {
          if (m.varied == "spheres" && m.measure == "refined" && m.shape == c.shape &&
              m.scene == c.scene && m.noise == f.noise)
            f.fixed.push_back({m.spheres, m.median_us, m.errors.volume.mean()});
        }
        f.scale = scene_scale(seen, t.model.radius, deepest * t.model.center_of_mass);
        f.level = t.model.levels[level_for_scene(t.model, f.scale)].sphere_count;
        QueryOptions query_options;
        query_options.level = f.level;
        query_options.device = options_.device;
        const ToolModel packed = packed_for(t.solid.solid(), f.scale);
        f.packed = static_cast<std::uint32_t>(packed.spheres.size());
        const ThreadCap cap(options_, 1);
        f.level_errors = measure(c, t.model, query_options, sensing(noise), f.level_us);
        f.packed_errors =
            measure(c, packed, {.device = options_.device}, sensing(noise), f.packed_us);
        fitted_.push_back(f);
      }
    }
  }

  static ToolModel packed_for(const Solid& solid, const SceneScale& scale) {
    PackOptions pack_options;
    pack_options.spheres = kUsual;
    pack_options.min_radius = scale.smallest_radius();
    pack_options.max_radius = scale.largest_radius();
    Packing packing;
    packing.spheres = pack(solid, pack_options).spheres;
    packing.solid = solid;
    return build_tool_model(packing, {});
  }

  const SuiteOptions& options_;
  const std::vector<std::uint32_t> levels_;
  const std::vector<Case> cases_;
  const int poses_;
  std::map<std::string, Tool> tools_;
  std::map<std::pair<std::string, std::string>, Run> runs_;
  std::map<std::tuple<std::string, Noise, NormalMethod, int, std::uint32_t>, AnyBody> clouds_;
  std::vector<Measured> measured_;
  std::vector<Kept> kept_;
  std::vector<Deadline> deadlines_;
  std::vector<Fitted> fitted_;
};

}  // namespace

Report run_tradeoff(const SuiteOptions& options) {
  return Tradeoff(options).run();
}

}  // namespace vpm::bench
