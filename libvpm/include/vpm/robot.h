// Robots as URDF describes them: links with their collision geometry, joints, and where links are.
// Library vpm::solid, but for link_poses(), which is in vpm::vpm. Functions are thread-safe.
//
//   const vpm::Robot robot = vpm::read_robot("arm.urdf", {.package_path = {"/opt/ros/share"}});
//   const std::vector<double> values(robot.movable.size(), 0);
//   const std::vector<vpm::Pose> poses = vpm::link_poses(robot, values);
#pragma once

#include <vpm/pose.h>
#include <vpm/remark.h>
#include <vpm/solid.h>

#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace vpm {

// A box, a cylinder about z or a sphere, each about the origin; or a mesh.
struct CollisionShape {
  enum class Kind { box, cylinder, sphere, mesh };
  Kind kind = Kind::box;
  Vec3 size;         // m: sides; radius, 0 and length; radius; of a mesh, its scale along each axis
  std::string mesh;  // path of the file
  Pose to_link;
};

struct RobotLink {
  std::string name;
  std::vector<CollisionShape> shapes;  // none of a link that is only a frame
};

struct RobotJoint {
  enum class Kind { fixed, revolute, continuous, prismatic };
  std::string name;
  Kind kind = Kind::fixed;
  std::size_t parent = 0, child = 0;  // links
  Pose origin;                        // maps the child's frame to the parent's where the value is 0
  Vec3 axis{1, 0, 0};                 // unit vector in the child's frame
  // rad or m; infinite where there are none.
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
  // The joint whose value this one follows: its own is multiplier times that, plus offset.
  std::optional<std::size_t> mimics = std::nullopt;
  double multiplier = 1, offset = 0;
};

struct Robot {
  std::string name;
  std::vector<RobotLink> links;      // the root first, each after its parent
  std::vector<RobotJoint> joints;    // joints[k] leads to links[k + 1]
  std::vector<std::size_t> movable;  // joints with a value of their own, in the order of the file
  Remarks remarks;                   // what may not be as it was meant

  // Returns the number of the link, or nothing if there is none of this name.
  std::optional<std::size_t> link(const std::string& name_of_link) const {
    for (std::size_t k = 0; k < links.size(); ++k)
      if (links[k].name == name_of_link) return k;
    return std::nullopt;
  }
};

struct RobotOptions {
  // Where `package://NAME/…` is looked for: folders that hold NAME, or that are it. The folders
  // about the file are asked last.
  std::vector<std::string> package_path = {};
};

// Reads a URDF file. Throws Error(refused), saying how to mend it, for what is no URDF (xacro,
// SDF), joints in a circle or of a kind that has no single value (planar, floating), packages and
// meshes that are not there, sizes that are not positive, and a robot without collision geometry.
VPM_API Robot read_robot(const std::string& path, const RobotOptions& options = {});

// Returns where the links are: poses that map each link's frame to the world, if `base` maps the
// root's, for a value, rad or m, of each of Robot::movable, in that order. Throws
// Error(invalid_argument) for another number of values, or one that is not finite.
VPM_API std::vector<Pose> link_poses(const Robot& robot, std::span<const double> values,
                                     const Pose& base = {});

// Returns the joints, movable or not, whose values are beyond their limits by more than 1e-9.
VPM_API std::vector<std::size_t> beyond_limits(const Robot& robot, std::span<const double> values);

// What stands for a cylinder or a sphere, which no mesh is: polyhedra inside of it, about it, or of
// its volume. The first two differ by .2 % in volume of a cylinder, and .8 % of a sphere.
enum class RoundShape { inside, outside, same_volume };

// Returns the solid of a link: all of its shapes as one, in the link's frame, m. Meshes are read as
// SolidMesh::read does, with `options` (but for the scale). Throws what that throws, naming link
// and file, and Error(invalid_argument) for a link without shapes.
VPM_API SolidMesh link_solid(const Robot& robot, std::size_t link,
                             RoundShape round = RoundShape::same_volume,
                             const SolidOptions& options = {});

// Returns the pairs of links that cannot collide in a way that matters, the smaller number first,
// in ascending order: those that `srdf` (a path) disables, or, if it is empty, links that a joint
// joins, also over links without shapes. Throws Error(refused) for an SRDF that is none or names
// other links.
VPM_API std::vector<std::array<std::size_t, 2>> ignored_pairs(const Robot& robot,
                                                              const std::string& srdf = {});

// Returns the text of a URDF file with spheres for the collision geometry of its links, by number,
// in each link's frame; all else in it stays, joints, inertia and what is seen, as `path` has it.
VPM_API std::string urdf_with_spheres(const std::string& path, const Robot& robot,
                                      std::span<const std::vector<Sphere>> spheres);

}  // namespace vpm
