// The measure of two solids and its peers.

#include <algorithm>
#include <array>
#include <random>

#include "libvpm/core/exact_pose.h"
#include "libvpm/solid/solid_pair.h"
#include "libvpm/solid/sphere_pair.h"
#include "libvpm/synthetic/shared_volume.h"
#include "tools/bench/peers/contest.h"
#include "tools/bench/peers/fcl_pair.h"
#include "tools/bench/peers/shells.h"
#include "tools/bench/penetration_case.h"
#include "tools/bench/solid_pairs.h"

namespace vpm::bench {
namespace {

using SurfacePtr = std::shared_ptr<const SolidSurface>;

// The measure itself, of the first solid as the tool.
class ExactPair : public Peer {
 public:
  ExactPair(const SurfacePtr& a, const SurfacePtr& b, bool with_force)
      : a_(a), b_(b), pair_(a, b), with_force_(with_force) {}

  PeerAnswer query(const Pose& pose) override {
    const SharedSolid shared = pair_.measure(pose, {}, with_force_);
    PeerAnswer answer;
    answer.volume = shared.volume;
    if (!with_force_) return answer;
    answer.wrench = {shared.force, shared.torque_about(pose * a_->center_of_mass())};
    return answer;
  }
  std::size_t bytes() const override { return a_->bytes() + b_->bytes(); }

 private:
  SurfacePtr a_, b_;
  SolidPair pair_;
  bool with_force_;
};

// The measure as printed, of the first solid as the tool: spheres against spheres.
class SpherePairPeer : public Peer {
 public:
  // The models must outlive it.
  SpherePairPeer(const ToolModel& a, const ToolModel& b, std::uint32_t spheres)
      : a_{a, a.level(spheres)}, b_{b, b.level(spheres)} {}

  PeerAnswer query(const Pose& pose) override {
    const SharedSolid shared = pair_.measure(a_, pose, b_, {});
    return {shared.volume,
            {shared.force, shared.torque_about(pose * a_.model.center_of_mass)},
            pair_.contacts()};
  }
  std::size_t bytes() const override {
    std::size_t bytes = 0;
    for (const InnerSphereTree* tree : {&a_, &b_}) {
      const Hierarchy& hierarchy = tree->level.hierarchy;
      bytes += tree->level.sphere_count * sizeof(Sphere) +
               hierarchy.nodes.size() * sizeof(HierarchyNode) +
               hierarchy.leaves.size() * sizeof(std::uint32_t);
    }
    return bytes;
  }

 private:
  InnerSphereTree a_, b_;
  SpherePair pair_;
};

// Integrates the force of the depth below `other` over the shell's points inside, by the closest
// points of its surface, about `about`. `pose` maps the shell's mesh to the frame of the other's.
Wrench force_of_depth(const PointShell& shell, const SolidSurface& other,
                      const DistanceField& field, const Pose& pose, Vec3 about) {
  const Pose placed{pose.rotation, pose * shell.center()};
  const DistanceField::ToVoxels to_voxels = field.to_voxels(placed);
  Wrench sum;
  for (const PointShell::Point& p : shell.points()) {
    if (field.distance(to_voxels(p.place)) > 2 * field.voxel()) continue;
    const Vec3 at = placed * widen(p.place);
    const double depth = other.exact_depth(at - other.center_of_mass()).value;
    if (!(depth > 0)) continue;
    const Vec3 force = -depth * (pose.rotation * widen(p.area));
    sum.force += force;
    sum.torque += cross(at - about, force);
  }
  return sum;
}

// Two solids as all peers have them. The first one is the tool.
class PairContest {
 public:
  PairContest(const PairOfSolids& pair, const SuiteOptions& options)
      : a_(pair.a),
        b_(pair.b),
        surface_a_(std::make_shared<const SolidSurface>(a_)),
        surface_b_(std::make_shared<const SolidSurface>(b_)),
        exact_(surface_a_, surface_b_, false),
        levels_(options.quick ? std::vector<std::uint32_t>{30, 100}
                              : std::vector<std::uint32_t>{100, 300, 1000, 3000}),
        model_a_(make_tool(a_, levels_)),
        model_b_(make_tool(b_, levels_)),
        shells_(a_, surface_a_->reach(), options.quick),
        field_(field_of(*surface_b_)) {
    for (const int voxels : options.quick ? std::vector{32} : std::vector{16, 32, 64})
      solids_.push_back({voxels, voxels_of(a_, voxels)});
    contest_.kind = "pairs", contest_.name = pair.name;
    contest_.volume = std::min(surface_a_->volume(), surface_b_->volume());
    contest_.radius = surface_a_->reach();
    contest_.contenders = [this](std::size_t) { return contenders(); };
    find_poses(options.quick);
    find_truth(options.quick);
  }
  const Contest& contest() const { return contest_; }

 private:
  // Returns the field of a solid, in its mesh's frame, with voxels as shells want them.
  std::shared_ptr<const DistanceField> field_of(const SolidSurface& surface) const {
    Box box;
    for (const Vec3& v : surface.tree().vertices()) box.add(v + surface.center_of_mass());
    const double voxel = shells_.field_voxel(surface.reach());
    box.low -= 3 * voxel * Vec3{1, 1, 1}, box.high += 3 * voxel * Vec3{1, 1, 1};
    return std::make_shared<const DistanceField>(box, voxel, [&](Vec3 x) {
      return -surface.exact_depth(x - surface.center_of_mass()).value;
    });
  }

  // Takes random turns and directions, with 1 to 20 % of the smaller solid shared.
  void find_poses(bool quick) {
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> turn(-2, 2);
    const auto vector = [&] { return Vec3{turn(random), turn(random), turn(random)}; };
    const double far = surface_a_->reach() + surface_b_->reach();
    for (const double part : {.01, .05, .1, .2})
      for (int k = 0; k < (quick ? 1 : 4); ++k) {
        const Rotation rotation = exact_rotation(rotation_from_vector(vector()));
        const Vec3 way = normalized_or_zero(vector());
        const auto at = [&](double apart) {
          return Pose{rotation, surface_b_->center_of_mass() + apart * way -
                                    rotation * surface_a_->center_of_mass()};
        };
        double low = 0, high = far;
        for (int step = 0; step < 40; ++step) {
          const double middle = .5 * (low + high);
          const bool shares = exact_.query(at(middle)).volume > part * contest_.volume;
          (shares ? low : high) = middle;
        }
        if (low > 0) contest_.poses.push_back(at(low));
      }
  }

  // Of each energy: of the depth below b, which a's shell integrates; and of both depths, each with
  // its weight by volumes, which the measure takes (libvpm/solid/README.md).
  void find_truth(bool quick) {
    const int parts = quick ? 50 : 200;
    const PointShell fine_a(a_, surface_a_->reach() / parts),
        fine_b(b_, surface_b_->reach() / parts);
    const auto field_a = field_of(*surface_a_);
    const double square_a = surface_a_->volume() * surface_a_->volume(),
                 square_b = surface_b_->volume() * surface_b_->volume(),
                 weight_b = square_b / (square_a + square_b);
    for (const Pose& pose : contest_.poses) {
      Solid moved = a_;
      for (Vec3& v : moved.vertices) v = pose * v;
      const double volume = synthetic::shared_volume(moved, b_);
      const Vec3 center = surface_a_->center_of_mass();
      const Wrench below_b = force_of_depth(fine_a, *surface_b_, *field_, pose, pose * center),
                   below_a = force_of_depth(fine_b, *surface_a_, *field_a, inverse(pose), center);
      one_sided_.push_back({volume, {}, true, below_b});
      const auto both = [&](Vec3 of_b, Vec3 of_a) {
        return weight_b * of_b - (1 - weight_b) * (pose.rotation * of_a);
      };
      symmetric_.push_back(
          {volume,
           {},
           true,
           {both(below_b.force, below_a.force), both(below_b.torque, below_a.torque)}});
    }
  }

  std::vector<Contender> contenders() const {
    std::vector<Contender> all;
    for (const bool with_force : {true, false})
      all.push_back({with_force ? "vpm" : "vpm, volume alone", "exact",
                     std::make_unique<ExactPair>(surface_a_, surface_b_, with_force), false,
                     &symmetric_});
    shells_.add_contenders(field_, one_sided_, all);
    for (const auto& [voxels, solid] : solids_)
      all.push_back({"voxels in the field", std::to_string(voxels) + " voxels",
                     std::make_unique<VoxelCountPeer>(solid, field_), false, &symmetric_});
    for (const std::uint32_t spheres : levels_)
      all.push_back({"spheres against spheres", std::to_string(spheres) + " spheres",
                     std::make_unique<SpherePairPeer>(model_a_, model_b_, spheres), true,
                     &symmetric_});
    if (std::unique_ptr<Peer> fcl = make_fcl_pair(a_, b_))
      all.push_back({"FCL, contacts", "all contacts", std::move(fcl), true, &symmetric_});
    return all;
  }

  Solid a_, b_;
  SurfacePtr surface_a_, surface_b_;
  ExactPair exact_;
  std::vector<std::uint32_t> levels_;
  ToolModel model_a_, model_b_;
  Shells shells_;
  std::shared_ptr<const DistanceField> field_;
  std::vector<std::pair<int, DistanceField>> solids_;
  std::vector<PeerTruth> one_sided_, symmetric_;
  Contest contest_;
};

}  // namespace

void contests_of_pairs(const SuiteOptions& options, const RunContest& run) {
  constexpr std::array kPairs{"torus-cube", "tori",         "gears, turned",
                              "bunny-spot", "fandisk-spot", "knot-bunny"};
  std::size_t done = 0;
  for (const PairOfSolids& pair : pairs_of_solids(options.quick, options.meshes)) {
    if (std::ranges::find(kPairs, pair.name) == kPairs.end()) continue;
    if (options.quick && done++ > 0) return;
    const PairContest contest(pair, options);
    run(contest.contest());
  }
}

}  // namespace vpm::bench
