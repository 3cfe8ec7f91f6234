// Voxmap-pointshell: points on the tool's surface that read their distance from a field of the
// scene. Three variants:
//
// flat     every point is read (McNeely, Puterbaugh, Troy 1999)
// tree     spheres over the points leave out those that are clear (Sagardia, Stouraitis, Lopes
//          e Silva 2014); the same contacts
// nested   levels of the tree from coarse to fine, a node standing for the points below it, as far
//          as a deadline allows (Barbic and James 2008)
//
// Each point has the area and the normal of its piece of the surface, so that its forces are a
// cubature of the force of the depth's energy: ∫ min(s, 0) n dA over the tool's surface. With equal
// weights, as in 1999, they would not converge to any. Likewise the volume is ∫ s ∇s·n dA, which is
// exact before a plane.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "libvpm/model/solid.h"
#include "tools/bench/peers/distance_field.h"
#include "tools/bench/peers/peer.h"

namespace vpm::bench {

class PointShell {
 public:
  // A point about the tool's centre of mass, m, and the area of its piece along its normal, m^2.
  struct Point {
    Vec3f place, area;
  };
  // Sphere around points [begin, end), whose areas its own point sums up.
  struct Node {
    Vec3f center;
    float radius = 0;
    std::uint32_t begin = 0, end = 0;
    std::uint32_t child = 0, children = 0;  // 0: the points themselves
    Point mean;
  };

  // Cuts the triangles into small pieces, and joins those of a voxel with edges of `spacing` that
  // face the same way to one point. McNeely's shells have the centres of these voxels instead.
  PointShell(const Solid& solid, double spacing);

  const std::vector<Point>& points() const { return points_; }
  const std::vector<Node>& nodes() const { return nodes_; }  // level by level, root first
  Vec3 center() const { return center_; }                    // of the tool's mass, mesh's frame
  std::size_t bytes(bool with_tree) const;

 private:
  Node node_of(std::uint32_t begin, std::uint32_t end) const;
  std::uint32_t halve(std::uint32_t begin, std::uint32_t end);

  Vec3 center_;
  std::vector<Point> points_;  // those of a node together
  std::vector<Node> nodes_;
};

enum class ShellWalk { flat, tree, nested };

class ShellPeer : public Peer {
 public:
  // `deadline` in seconds, of the nested levels only.
  ShellPeer(std::shared_ptr<const PointShell> shell, std::shared_ptr<const DistanceField> field,
            ShellWalk walk, double deadline = 0)
      : shell_(std::move(shell)), field_(std::move(field)), walk_(walk), deadline_(deadline) {}

  PeerAnswer query(const Pose& pose) override;
  std::size_t bytes() const override { return bytes_without_field() + field_->bytes(); }
  std::size_t bytes_without_field() const override {
    return shell_->bytes(walk_ != ShellWalk::flat);
  }

 private:
  struct Sum;
  void walk_tree(Sum& sum);
  void walk_levels(Sum& sum);

  std::shared_ptr<const PointShell> shell_;
  std::shared_ptr<const DistanceField> field_;
  ShellWalk walk_;
  double deadline_;
  std::vector<std::uint32_t> open_, next_;  // nodes
};

// Counts the voxels of a solid that lie inside a field of the scene: the volume, as validation by
// voxels has it; no force.
class VoxelCountPeer : public Peer {
 public:
  // `tool` is the field of the tool, in its mesh's frame.
  VoxelCountPeer(const DistanceField& tool, std::shared_ptr<const DistanceField> scene)
      : places_(tool.places_inside()), voxel_(tool.voxel()), scene_(std::move(scene)) {}

  PeerAnswer query(const Pose& pose) override;
  std::size_t bytes() const override { return bytes_without_field() + scene_->bytes(); }
  std::size_t bytes_without_field() const override { return places_.size() * sizeof places_[0]; }

 private:
  std::vector<Vec3f> places_;
  double voxel_;
  std::shared_ptr<const DistanceField> scene_;
};

}  // namespace vpm::bench
