// The measure and its peers before a depth image: walls, clutter, recorded rooms.

#include <algorithm>

#include "libvpm/cloud/normals.h"
#include "libvpm/query/tool_query.h"
#include "libvpm/solid/solid_surface.h"
#include "libvpm/synthetic/scenes.h"
#include "tools/bench/clutter.h"
#include "tools/bench/errors.h"
#include "tools/bench/peers/contest.h"
#include "tools/bench/peers/point_shell.h"
#include "tools/bench/peers/shells.h"
#include "tools/bench/penetration_case.h"
#include "tools/bench/poses_in_clutter.h"
#include "tools/bench/recorded_images.h"
#include "tools/bench/replay_peers.h"

namespace vpm::bench {
namespace {

constexpr double kLeastShare = .005;  // of the tool, at the poses in clutter and rooms

// Holds what each peer makes of one tool: packing and model, point shells, and voxels.
struct DepthTool {
  DepthTool(const std::string& shape, const SuiteOptions& options)
      : levels(options.quick ? std::vector<std::uint32_t>{30, 100}
                             : std::vector<std::uint32_t>{30, 100, 300, 1000, 3000, 10000}),
        packed(
            make_packed(shape, levels, options.quick ? PackedSolid::kFewPlaces : kCountedPlaces)),
        shells(packed.solid.solid(), packed.model.radius, options.quick) {
    for (const int voxels : options.quick ? std::vector{32} : std::vector{16, 32, 64}) {
      grids.push_back({voxels, std::make_shared<const Peers>(packed.solid.solid(), voxels)});
      solids.push_back(voxels_of(packed.solid.solid(), voxels));
    }
  }

  std::vector<std::uint32_t> levels;
  PackedSolid packed;
  Shells shells;
  std::vector<std::pair<int, std::shared_ptr<const Peers>>> grids;
  std::vector<DistanceField> solids;  // inside -1, outside 1, for each of the grids
};

// Moves each point of a cloud onto the surface that the measure reads in its place, without noise.
Cloud denoised(Cloud cloud, const DepthBody& body) {
  const Pose to_camera = inverse(body.to_world());
  const DepthSurface surface = body.surface();
  for (std::size_t k = 0; k < cloud.size(); ++k) {
    const Vec3 place = cloud.origin + widen(cloud.positions[k]);
    const SurfaceSample on = surface.sample(to_camera * place);
    if (!on.known) continue;
    const Vec3 normal = body.to_world().rotation * on.normal;
    cloud.positions[k] = narrow(place - on.distance * normal - cloud.origin);
    cloud.normals[k] = narrow(normal);
  }
  return cloud;
}

// What a peer may read of a camera's image.
struct DepthFrame {
  DepthFrame(const Cloud& cloud, const Box& box, double voxel)
      : body(cloud),
        measured(cloud, Denoising::off),
        pixels(make_pixel_cloud(cloud.sensor->depth, cloud.sensor->camera)),
        field(field_of(cloud, box, voxel)),
        denoised_field(field_of(denoised(cloud, *body.as<DepthBody>()), box, voxel)) {}

  static std::shared_ptr<const DistanceField> field_of(const Cloud& cloud, const Box& box,
                                                       double voxel) {
    return std::make_shared<const DistanceField>(DistanceField::of_points(cloud, box, voxel));
  }

  AnyBody body, measured;
  PixelCloud pixels;
  std::shared_ptr<const DistanceField> field, denoised_field;
};

// The measure itself.
class MeasurePeer : public Peer {
 public:
  MeasurePeer(const ToolModel& model, std::uint32_t level, Measure measure, const AnyBody& body)
      : query_(model, {.measure = measure, .level = level}), body_(body) {}

  PeerAnswer query(const Pose& pose) override {
    const Result result = query_.run(body_, pose);
    return {result.volume, result.wrench, 0};
  }
  // The level; and of the image normals, measured depths and pyramid, and the points with their
  // normals, which only the measure as printed reads.
  std::size_t bytes() const override {
    const Level& l = query_.level();
    const Camera& camera = body_.as<DepthBody>()->prepared().camera();
    const std::size_t pixels = std::size_t{camera.width} * camera.height;
    return l.samples.size() * sizeof(CellSample) + l.faces.size() * sizeof(SampleFace) +
           l.blocks.size() * sizeof(CellBlock) + l.graph.neighbors.size() * sizeof(std::uint32_t) +
           l.hierarchy.nodes.size() * sizeof(HierarchyNode) +
           l.sphere_count * (sizeof(Sphere) + sizeof(Vec3) + 2 * sizeof(double)) +
           pixels * (sizeof(Vec3f) + sizeof(float) + sizeof(std::uint32_t)) +
           pixels * sizeof(InverseDepthRange) * 4 / 3 + body_.points() * 2 * sizeof(Vec3f);
  }

 private:
  ToolQuery query_;
  AnyBody body_;
};

// The tool's distance grid, which pixels read; or its voxels, which read pixels.
class PixelPeer : public Peer {
 public:
  PixelPeer(std::shared_ptr<const Peers> grid, const PixelCloud& pixels, Vec3 center, bool counts)
      : grid_(std::move(grid)), pixels_(pixels), center_(center), counts_(counts) {}

  PeerAnswer query(const Pose& pose) override {
    const Pose& camera = pixels_.camera.to_world;
    const Pose seen = relative_to(camera, pose);
    PeerAnswer answer;
    if (counts_) {
      answer.volume = grid_->count_voxels(pixels_, seen);
      return answer;
    }
    Wrench w = grid_->penalty(pixels_, seen);  // about the mesh's origin
    w.torque -= cross(seen * center_ - seen.translation, w.force);
    answer.wrench = {camera.rotation * w.force, camera.rotation * w.torque};
    return answer;
  }
  std::size_t bytes() const override {
    return grid_->bytes(counts_) +
           pixels_.depth.depth.size() * (counts_ ? sizeof(float) : 2 * sizeof(Vec3f));
  }

 private:
  std::shared_ptr<const Peers> grid_;
  const PixelCloud& pixels_;
  Vec3 center_;
  bool counts_;
};

std::vector<Contender> contenders_of(const DepthTool& tool, const DepthFrame& frame,
                                     const std::vector<PeerTruth>& truth) {
  std::vector<Contender> all;
  const auto add_measure = [&](const char* name, Measure measure, const AnyBody& body) {
    for (const std::uint32_t level : tool.levels)
      all.push_back({name, std::to_string(level) + " spheres",
                     std::make_unique<MeasurePeer>(tool.packed.model, level, measure, body), false,
                     &truth});
  };
  add_measure("vpm", Measure::refined, frame.body);
  add_measure("vpm, points as measured", Measure::refined, frame.measured);
  tool.shells.add_contenders(frame.field, truth, all);
  tool.shells.add_tree("pointshell, tree, points denoised by vpm", frame.denoised_field, truth,
                       all);
  for (std::size_t k = 0; k < tool.grids.size(); ++k)
    all.push_back({"voxels in the field", std::to_string(tool.grids[k].first) + " voxels",
                   std::make_unique<VoxelCountPeer>(tool.solids[k], frame.field), false, &truth});
  for (const bool counts : {false, true})
    for (const auto& [voxels, grid] : tool.grids)
      all.push_back({counts ? "OpenVDB, count behind pixels" : "distance grid, penalty of pixels",
                     std::to_string(voxels) + " voxels",
                     std::make_unique<PixelPeer>(grid, frame.pixels,
                                                 tool.packed.model.center_of_mass, counts),
                     !counts, &truth});
  add_measure("as printed in 2017", Measure::paper, frame.body);
  return all;
}

// Returns the box that holds the tool at all poses.
Box around(const std::vector<Pose>& poses, const ToolModel& tool) {
  Box box;
  for (const Pose& pose : poses)
    for (const double side : {-1.01, 1.01})
      box.add(pose * tool.center_of_mass + side * tool.radius * Vec3{1, 1, 1});
  return box;
}

// Returns four poses: one in the middle of the list and those nearest to it, since fields around
// them are made anew for each noisy frame.
std::vector<Pose> near_each_other(std::vector<Pose> poses) {
  constexpr std::size_t kStill = 4;
  const Vec3 middle = poses[poses.size() / 2].translation;
  std::ranges::sort(poses, {}, [&](const Pose& p) { return squared_norm(p.translation - middle); });
  poses.resize(std::min(kStill, poses.size()));
  return poses;
}

// Makes a contest of poses; `cloud` gives what the camera sees in a frame, 0 for the first.
class DepthContest {
 public:
  DepthContest(const std::string& kind, const std::string& name, const DepthTool& tool,
               std::vector<Pose> poses, std::vector<PeerTruth> truth,
               std::function<Cloud(std::size_t frame)> cloud, std::size_t noisy_frames)
      : tool_(tool), truth_(std::move(truth)), cloud_(std::move(cloud)) {
    contest_.kind = kind, contest_.name = name;
    contest_.volume = tool.packed.solid.mass().volume;
    contest_.radius = tool.packed.model.radius;
    contest_.poses = std::move(poses);
    contest_.noisy_frames = noisy_frames;
    contest_.whole_field = bytes_of_view();
    if (noisy_frames > 0) contest_.still = near_each_other(contest_.poses);
    contest_.contenders = [this](std::size_t frame) {
      const std::vector<Pose>& asked = frame == 0 ? contest_.poses : contest_.still;
      frame_ = std::make_unique<const DepthFrame>(cloud_(frame), around(asked, tool_.packed.model),
                                                  tool_.shells.field_voxel(contest_.radius));
      return contenders_of(tool_, *frame_, truth_);
    };
  }
  const Contest& contest() const { return contest_; }

 private:
  // Returns the memory of a field that holds the tool wherever it touches what the camera sees
  // within kArm of itself.
  std::size_t bytes_of_view() const {
    constexpr double kArm = 2;  // m
    const Cloud cloud = cloud_(0);
    const Vec3 eye = cloud.sensor->camera.to_world.translation;
    Box box;
    for (const Vec3f& place : cloud.positions)
      for (const double side : {-1.0, 1.0})
        if (norm(cloud.origin + widen(place) - eye) < kArm)
          box.add(cloud.origin + widen(place) + side * contest_.radius * Vec3{1, 1, 1});
    if (!(box.low.x < box.high.x)) return 0;
    return DistanceField::bytes_of(box, tool_.shells.field_voxel(contest_.radius));
  }

  const DepthTool& tool_;
  std::vector<PeerTruth> truth_;
  std::function<Cloud(std::size_t frame)> cloud_;
  std::unique_ptr<const DepthFrame> frame_;
  Contest contest_;
};

void run_walls(const DepthTool& tool, const std::string& shape, const std::string& scene_name,
               const SuiteOptions& options, const RunContest& run) {
  const synthetic::Scene scene = synthetic::make_scene(scene_name);
  const std::vector<Pose> poses = make_sweep(tool.packed.solid, {turned(), {.012, -.007, 0}},
                                             *scene.surface, options.quick ? 4 : 24);
  std::vector<PeerTruth> truth;
  for (const synthetic::Penetration& p : truth_along(tool.packed.solid, poses, *scene.surface))
    truth.push_back({p.volume, {}, true, {p.force, p.torque}});
  const auto cloud = [&](std::size_t frame) {
    return make_cloud(
        frame == 0 ? synthetic::render(*scene.surface, scene.camera)
                   : synthetic::render_with_kinect_noise(*scene.surface, scene.camera, frame),
        scene.camera, NormalOptions{});
  };
  const DepthContest contest("walls", shape + ", " + scene_name, tool, poses, truth, cloud,
                             options.quick ? 2 : 10);
  run(contest.contest());
}

// Takes random poses at which a camera can know nearly all of the tool.
void run_clutter(const DepthTool& tool, const SuiteOptions& options, const RunContest& run) {
  const synthetic::SurfacePtr surface = clutter_surface();
  const Cloud seen = make_clutter();
  std::vector<bool> hole;
  for (const float depth : seen.sensor->depth.depth) hole.push_back(!is_measured(depth));
  const std::vector<Sight> sights{Sight(*surface, seen.sensor->camera, &hole)};
  const std::size_t wanted = options.quick ? 1 : 24;
  const double tolerance = options.quick ? 1e-3 : 1e-5;  // of the truth
  std::vector<Pose> poses;
  std::vector<PeerTruth> truth;
  for (const Pose& pose : poses_in_clutter(seen, 3000)) {
    if (poses.size() == wanted) break;
    const auto places = tool.packed.few_places().first(options.quick ? 1024 : 4096);
    const auto inside = std::ranges::count_if(
        places, [&](Vec3 place) { return surface->distance(pose * place) < 0; });
    const double part = static_cast<double>(inside) / static_cast<double>(places.size());
    if (!(part > kLeastShare && part < kFullest)) continue;
    const Unseen unseen = unseen_parts(places, pose, *surface, sights);
    if (unseen.free + unseen.inside > kDepthKnown * part || unseen.foot > kDepthKnown * part)
      continue;
    const synthetic::Penetration p = tool.packed.solid.penetration(pose, *surface, tolerance);
    poses.push_back(pose);
    truth.push_back({p.volume, unseen, true, {p.force, p.torque}});
  }
  const auto cloud = [&](std::size_t frame) { return frame == 0 ? seen : make_clutter(frame); };
  const DepthContest contest("clutter", "table", tool, poses, truth, cloud, options.quick ? 0 : 10);
  run(contest.contest());
}

// Nobody knows the true surface of a room: volumes are compared with a count of what lies behind
// the image, forces are not.
void run_recorded(const DepthTool& tool, const SuiteOptions& options, const RunContest& run) {
  const double whole = tool.packed.solid.mass().volume;
  std::string recording;
  for (const RecordedImage& image : recorded_images(options.data)) {
    const std::string of = image.name.substr(0, image.name.find('/'));
    if (of == recording) continue;  // frames of one recording are alike
    recording = of;
    std::vector<Pose> poses;
    std::vector<PeerTruth> truth;
    constexpr std::uint64_t kMostTries = 100000;
    constexpr double kApart = .25;  // m; a field of the whole room has gigabytes
    for (std::uint64_t k = 0; k < kMostTries && poses.size() < (options.quick ? 3 : 24); ++k) {
      const Pose pose = random_pose_before(image.cloud, k, tool.packed.model.radius);
      if (!poses.empty() && norm(pose.translation - poses[0].translation) > kApart) continue;
      const auto count = [&](std::span<const Vec3> places) {
        return count_behind(places, tool.packed.model.radius, pose, image.cloud.sensor->depth,
                            image.cloud.sensor->camera);
      };
      const double part = count(tool.packed.few_places()).behind;
      if (!(part > kLeastShare && part < kShallow)) continue;
      const ProjectiveCount behind = count(tool.packed.places);
      poses.push_back(pose);
      truth.push_back({behind.behind * whole, {.inside = behind.occluded}, false, {}});
    }
    if (poses.empty()) continue;
    const DepthContest contest(
        "recorded", image.name, tool, poses, truth, [&](std::size_t) { return image.cloud; }, 0);
    run(contest.contest());
  }
}

}  // namespace

void contests_of_depth(const SuiteOptions& options, const RunContest& run) {
  const DepthTool torus("twisted-torus", options);
  run_walls(torus, "twisted torus", "tilted-wall", options, run);
  if (!options.quick) {
    const DepthTool cube("cube", options);
    run_walls(cube, "cube", "tilted-wall", options, run);
    run_walls(cube, "cube", "wall", options, run);
  }
  run_clutter(torus, options, run);
  if (!options.data.empty()) run_recorded(torus, options, run);
}

}  // namespace vpm::bench
