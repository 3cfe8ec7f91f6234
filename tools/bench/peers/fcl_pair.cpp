#include "tools/bench/peers/fcl_pair.h"

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/narrowphase/collision.h>

#include <limits>

#include "libvpm/core/pose.h"

namespace vpm::bench {

const bool kHasFcl = true;

namespace {

using Mesh = fcl::BVHModel<fcl::OBBRSSd>;

fcl::Vector3d vector_of(Vec3 v) {
  return {v.x, v.y, v.z};
}

std::shared_ptr<Mesh> mesh_of(const Solid& solid) {
  auto mesh = std::make_shared<Mesh>();
  mesh->beginModel(static_cast<int>(solid.triangles.size()),
                   static_cast<int>(solid.vertices.size()));
  for (const Triangle& t : solid.triangles)
    mesh->addTriangle(vector_of(solid.vertices[t[0]]), vector_of(solid.vertices[t[1]]),
                      vector_of(solid.vertices[t[2]]));
  mesh->endModel();
  return mesh;
}

class FclPair : public Peer {
 public:
  FclPair(const Solid& a, const Solid& b)
      : center_(mass_properties(a).center_of_mass), a_(mesh_of(a)), b_(mesh_of(b)) {
    request_.enable_contact = true;
    request_.num_max_contacts = std::numeric_limits<int>::max();
  }

  PeerAnswer query(const Pose& pose) override {
    fcl::Transform3d placed = fcl::Transform3d::Identity();
    const Vec3 rows[] = {pose.rotation.row0, pose.rotation.row1, pose.rotation.row2};
    for (int k = 0; k < 3; ++k) placed.linear().row(k) = vector_of(rows[k]).transpose();
    placed.translation() = vector_of(pose.translation);
    fcl::CollisionResultd result;
    fcl::collide(a_.get(), placed, b_.get(), fcl::Transform3d::Identity(), request_, result);
    PeerAnswer sum{NAN, {}, result.numContacts()};
    const Vec3 about = pose * center_;
    for (std::size_t k = 0; k < result.numContacts(); ++k) {
      const fcl::Contactd& c = result.getContact(k);  // its normal leads from a to b
      const Vec3 force =
          -std::abs(c.penetration_depth) * Vec3{c.normal.x(), c.normal.y(), c.normal.z()};
      sum.wrench.force += force;
      sum.wrench.torque += cross(Vec3{c.pos.x(), c.pos.y(), c.pos.z()} - about, force);
    }
    return sum;
  }

  std::size_t bytes() const override {
    const auto of = [](const Mesh& mesh) {
      return static_cast<std::size_t>(mesh.getNumBVs()) * sizeof(fcl::BVNode<fcl::OBBRSSd>) +
             static_cast<std::size_t>(mesh.num_tris) * sizeof(fcl::Triangle) +
             static_cast<std::size_t>(mesh.num_vertices) * sizeof(fcl::Vector3d);
    };
    return of(*a_) + of(*b_);
  }

 private:
  Vec3 center_;
  std::shared_ptr<Mesh> a_, b_;
  fcl::CollisionRequestd request_;
};

}  // namespace

std::unique_ptr<Peer> make_fcl_pair(const Solid& a, const Solid& b) {
  return std::make_unique<FclPair>(a, b);
}

}  // namespace vpm::bench
