// How much two solids share, and which wrench parts them: exact for closed meshes at any pose.
// Library vpm::solid.
//
//   const vpm::SolidBody gear(vpm::SolidMesh::read("gear.stl", {.scale = 0.001}));
//   const vpm::SolidBody shaft(vpm::SolidMesh::read("shaft.stl", {.scale = 0.001}));
//   const vpm::Overlap o = vpm::overlap(gear, {}, shaft, vpm::Pose{{}, {0, 0, 0.01}});
//   const double cubic_millimetres = 1e9 * o.volume;
//
// The volume is that of the boundary of what both solids contain, by the divergence theorem over
// the parts of each surface inside the other: flush faces share nothing, thin overlaps are not
// lost, coincident and enclosed solids are no special cases. Signs are exact (Shewchuk 1997). The
// force is that of the energy ∫ depth dV (libvpm/solid/README.md).
#pragma once

#include <vpm/error.h>
#include <vpm/export.h>
#include <vpm/pose.h>
#include <vpm/query_types.h>
#include <vpm/solid.h>

#include <cstddef>
#include <memory>

namespace vpm {

class SolidSurface;  // the library's own

// Handle of a solid made ready to be measured against others; immutable, copies share it.
// Thread-safe.
class VPM_API SolidBody {
 public:
  // Prepares what the mesh encloses at least once, so a mesh that crosses itself counts its
  // overlaps once: .2 s for 7000 triangles, 1 s for 86 000. `with_force` false leaves out what
  // forces need, which is most of that. Throws Error(refused) for a mesh without volume.
  explicit SolidBody(const SolidMesh& mesh, bool with_force = true);

  // Returns the volume, m^3.
  double volume() const;
  // Returns the centre of mass in the mesh's frame, m.
  Vec3 center_of_mass() const;
  // Returns the largest distance of a point of the solid from the centre of mass, m.
  double radius() const;
  // Returns the number of triangles that bound the solid.
  std::size_t triangles() const;

 private:
  friend HandleAccess;
  explicit SolidBody(std::shared_ptr<const SolidSurface> surface) : surface_(std::move(surface)) {}

  std::shared_ptr<const SolidSurface> surface_;  // null once moved from
};

// What two solids a and b share. All places, directions and moments are in the world's frame and
// axes. Volumes and areas are those of the meshes, to 1e-9 of the smaller solid where neither
// radius is more than a hundred times the other (1e-6 up to a thousand times).
struct Overlap {
  double volume = 0;  // m^3; 0 if they touch or are apart
  Vec3 centroid;      // of the shared solid, m; 0 if there is none
  // ∫ n dA over the part of a's surface inside b, m^2: the volume's gradient where a moves. b's is
  // the opposite. Its direction is the mean normal of the contact, from a into b.
  Vec3 area;
  // The volume's gradient where a turns about the centroid, per radian, m^3; b's is the opposite.
  Vec3 turn;
  // Force and torque on a, times the stiffness. The torque is about the centroid. Those on b are
  // the opposite, in the same bits. They push a out of b: against a solid much larger than a, the
  // force is stiffness times volume where the nearest face of b is one plane.
  Wrench wrench;
  // How far the boundary of the shared solid is from closed, relative to the smaller radius: |∫ n
  // dA| over its square, |∫ x cross n dA| over its cube, the larger. Below 1e-8 in all answers.
  double closure = 0;

  friend constexpr bool operator==(const Overlap&, const Overlap&) = default;
};

struct OverlapOptions {
  bool with_force = true;  // false leaves the wrench 0 and takes less time
  double stiffness = 1;    // N/m^3: the wrench is in N and N m; 1 leaves it in m^3 and m^4
};

// Measures two solids at many poses. Shares the bodies, so nothing dangles. Belongs to one thread
// at a time; bodies may be shared between threads. a and b swapped give the same bits, with the
// vectors' signs turned but for the centroid's; the same input gives the same bits always.
class VPM_API OverlapQuery {
 public:
  // Throws Error(invalid_argument) for a stiffness that is not positive and finite, and for forces
  // of bodies made without.
  OverlapQuery(const SolidBody& a, const SolidBody& b, const OverlapOptions& options = {});
  ~OverlapQuery();
  OverlapQuery(OverlapQuery&&) noexcept;
  OverlapQuery& operator=(OverlapQuery&&) noexcept;

  // Returns what a and b share at poses that map their meshes to the world. Rotations that are off
  // by rounding (1e-5) are taken for the nearest ones. Takes time of the contact's size. Throws
  // Error(refused) for a pose that is not finite, not rigid or further than 2^100 m from the
  // origin, and if the boundary of what is shared does not close, which is a defect of a mesh: no
  // answer is given then.
  Overlap run(const Pose& pose_a, const Pose& pose_b);

 private:
  struct Impl;
  Impl& impl() const;

  std::unique_ptr<Impl> impl_;  // null once moved from
};

// Returns OverlapQuery(a, b, options).run(pose_a, pose_b), for a single pose. Thread-safe.
VPM_API Overlap overlap(const SolidBody& a, const Pose& pose_a, const SolidBody& b,
                        const Pose& pose_b, const OverlapOptions& options = {});

}  // namespace vpm
