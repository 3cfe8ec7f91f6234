// From a mesh to a tool: reading, packing with spheres, levels of detail. And what two solids
// share. Library vpm::solid; what concerns Tool, SolidBody and overlaps alone is in vpm::vpm.
//
//   const vpm::SolidMesh mesh = vpm::SolidMesh::read("gripper.stl", {.scale = 0.001});
//   const vpm::Tool tool = vpm::build_tool(vpm::pack(mesh, {.spheres = 1000}), {.levels = {250}});
//
// Functions are thread-safe unless they say otherwise, and use several threads inside; the same
// input gives the same bytes, for any number of threads.
#pragma once

#include <vpm/error.h>
#include <vpm/pose.h>
#include <vpm/query_types.h>
#include <vpm/tool.h>

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace vpm {

// Says what to do with a mesh that is no solid.
enum class Repair {
  none,   // refuse what is not a solid
  holes,  // drop repeated triangles, fill planar and small holes
  voxel,  // new surface about the voxels that the mesh encloses
  flood,  // new surface about the voxels that a ball of max_hole cannot reach
};

// Number of voxels along the longest side for Repair::voxel and flood, unless said otherwise.
inline constexpr int kRepairVoxels = 128;

struct SolidOptions {
  // Unit of the file in metres. If unset: 1, and a mesh of a size that few tools have, but many in
  // millimetres, gives a warning.
  std::optional<double> scale = std::nullopt;
  // Vertices nearer than this, relative to the bounding box's diagonal, are joined. If unset:
  // 1e-9 for STL; for formats with indices too, but only if the mesh is open before and
  // closed after.
  std::optional<double> weld = std::nullopt;
  Repair repair = Repair::none;
  int repair_voxels = kRepairVoxels;  // along the longest side, for Repair::voxel and flood
  // m; wider holes are refused. If unset: no limit for
  // Repair::voxel, a sixteenth of the longest side for Repair::flood.
  std::optional<double> max_hole = std::nullopt;
  // Node of a COLLADA, glTF, 3MF or FBX scene that is read with what is below it, by its name; "":
  // all.
  std::string node = {};
};

struct CheckedSolid;  // the library's own
struct Packing;       // the library's own
class SolidSurface;   // the library's own

// Handle of an immutable closed mesh, oriented outward, in metres; copies share it.
class VPM_API SolidMesh {
 public:
  // Reads an OBJ, OFF, PLY, STL or OM file, told by its content, and makes a solid of it; "-" is
  // standard input. COLLADA, glTF and FBX are read in a child process where assimp was built, 3MF
  // where expat was, otherwise Error(unavailable) is thrown; all their nodes are joined. Throws
  // Error(refused) naming the file with line, byte or element for what is damaged, and the rims of
  // holes, edges or vertices where it is no solid beyond the repair of the options;
  // Error(invalid_argument) for options out of range.
  static SolidMesh read(const std::string& path, const SolidOptions& options = {});

  // Makes a solid of triangles, counter-clockwise seen from outside, by the same rules.
  static SolidMesh from_triangles(std::span<const Vec3> vertices,
                                  std::span<const std::array<std::uint32_t, 3>> triangles,
                                  const SolidOptions& options = {});

  double volume() const;  // that is enclosed at least once, m^3
  std::size_t vertices() const;
  std::size_t triangles() const;
  // Returns what was mended, and what was accepted though it may surprise, in sentences.
  std::vector<std::string> notes() const;
  std::vector<std::string> warnings() const;

 private:
  friend HandleAccess;
  explicit SolidMesh(std::shared_ptr<const CheckedSolid> solid) : solid_(std::move(solid)) {}

  std::shared_ptr<const CheckedSolid> solid_;  // null once moved from
};

// Handle of an immutable packing: spheres that neither overlap nor leave the solid, largest first,
// with the solid; copies share it.
class VPM_API SpherePacking {
 public:
  // Reads and writes .vpmp files (formats/packing.md); errors as for Tool.
  static SpherePacking read(const std::string& path);
  void write(const std::string& path) const;

  std::vector<Sphere> spheres() const;

 private:
  friend HandleAccess;
  explicit SpherePacking(std::shared_ptr<const Packing> packing) : packing_(std::move(packing)) {}

  std::shared_ptr<const Packing> packing_;  // null once moved from
};

struct PackingParameters {
  std::size_t spheres = 1000;  // as many are placed unless another limit comes first
  double coverage = 1;         // stops where the spheres fill this fraction of the solid's volume
  double min_radius = 0;       // m
  double max_radius = std::numeric_limits<double>::infinity();  // m
  bool grow = false;  // all spheres grow together afterwards: more coverage with as many
  // Called between steps on the calling thread; fraction from 0 to 1.
  std::function<void(double fraction)> progress = nullptr;
};

// Returns a packing with always the largest sphere that fits into what is left of the solid. Holds
// a certificate, checked before it is returned: no overlap and no protrusion beyond 1e-9 of the
// longest side. Throws Error(refused) if no sphere fits or the mesh crosses itself in ways that
// leave open what is inside; Error(invalid_argument) for limits out of range.
VPM_API SpherePacking pack(const SolidMesh& solid, const PackingParameters& parameters = {});

struct ToolParameters {
  std::vector<std::uint32_t> levels;  // spheres of further levels; the whole packing always is one
  double epsilon = 0;      // m, largest gap of an edge; 0: a tenth of a level's smallest radius
  bool calibrate = false;  // measures each level's error against the solid, for LevelRequest
  std::function<void(double fraction)> progress = nullptr;  // as PackingParameters::progress
};

// Returns the tool of a packing: every point of the solid's volume belongs to its nearest sphere
// (additively weighted Voronoi cells), so no volume is lost between spheres. Throws Error(refused)
// for a packing that is none, Error(invalid_argument) for parameters out of range.
VPM_API Tool build_tool(const SpherePacking& packing, const ToolParameters& parameters = {});

// How much two solids share, and which wrench parts them, at any pose:
//
//   const vpm::SolidBody gear(vpm::SolidMesh::read("gear.stl", {.scale = 0.001}));
//   const vpm::Overlap o = vpm::overlap(gear, {}, gear, vpm::Pose{{}, {0, 0, 0.01}});
//   const double cubic_millimetres = 1e9 * o.volume;
//
// The volume is that of the boundary of what both contain, by the divergence theorem over the parts
// of each surface inside the other: flush faces share nothing, thin overlaps are not lost,
// coincident and enclosed solids are no special cases. Signs are exact (Shewchuk 1997). The force
// is that of the energy ∫ depth dV (libvpm/solid/README.md).

// Handle of a solid made ready to be measured against others; immutable, copies share it.
// Thread-safe.
class VPM_API SolidBody {
 public:
  // Prepares what the mesh encloses at least once, so a mesh that crosses itself counts its
  // overlaps once: .2 s for 7000 triangles, 1 s for 86 000. `with_force` false leaves out what
  // forces need, which is most of that. Throws Error(refused) for a mesh without volume.
  explicit SolidBody(const SolidMesh& mesh, bool with_force = true);
  // Prepares the surface of a tool model, in its mesh's frame; Measure::paper takes its spheres.
  // This and all below is in the library vpm. Throws Error(refused) for a model without a surface.
  explicit SolidBody(const Tool& tool, bool with_force = true);

  double volume() const;          // m^3
  Vec3 center_of_mass() const;    // in the mesh's frame, m
  double radius() const;          // largest distance of a point of the solid from that, m
  std::size_t triangles() const;  // that bound the solid

 private:
  friend HandleAccess;
  explicit SolidBody(std::shared_ptr<const SolidSurface> surface) : surface_(std::move(surface)) {}

  std::shared_ptr<const SolidSurface> surface_;  // null once moved from
  std::shared_ptr<const ToolModel> model_;       // whose spheres it has; null for a mesh
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
  // force is stiffness times volume where the nearest face of b is one plane. It is never more than
  // that but for its error: .15 % of the smaller solid's volume and, where little is shared, 7 % of
  // what is (1 % as a rule) from a depth of 1e-4 radii on.
  Wrench wrench;
  // How far the boundary of the shared solid is from closed, relative to the smaller radius: |∫ n
  // dA| over its square, |∫ x cross n dA| over its cube, the larger. Below 1e-8 in all answers.
  double closure = 0;
  // Contacts of which all this is the sum, about the same point, if the options ask for them;
  // empty if the volume is 0.
  std::vector<Contact> contacts;

  friend bool operator==(const Overlap&, const Overlap&) = default;
};

struct OverlapOptions {
  bool with_force = true;      // false leaves the wrench 0 and takes less time
  double stiffness = 1;        // N/m^3: the wrench is in N and N m; 1 leaves it in m^3 and m^4
  std::uint32_t contacts = 0;  // listed each by itself; all others are summed in one. 0: none
  Device device = {};  // for volumes alone: the CPU measures wrenches and contacts. Same bits
};

// Measures two solids at many poses. Shares the bodies, so nothing dangles. Belongs to one thread
// at a time; bodies may be shared between threads. a and b swapped give the same bits, with the
// vectors' signs turned but for the centroid's; the same input gives the same bits always.
class VPM_API OverlapQuery {
 public:
  // Throws Error(invalid_argument) for a stiffness that is not positive and finite, and for forces
  // of bodies made without; Error(unavailable) if the device is not there, as run() if it fails.
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

  // Stores the answers for a[k] and b[k] as those of one by one: a device takes thousands at once,
  // the CPU uses several threads. Throws Error(invalid_argument) unless there are as many of each.
  void run(std::span<const Pose> a, std::span<const Pose> b, std::span<Overlap> answers);

 private:
  struct Impl;
  Impl& impl() const;

  std::unique_ptr<Impl> impl_;  // null once moved from
};

// Returns OverlapQuery(a, b, options).run(pose_a, pose_b), for a single pose. Thread-safe.
VPM_API Overlap overlap(const SolidBody& a, const Pose& pose_a, const SolidBody& b,
                        const Pose& pose_b, const OverlapOptions& options = {});

// A part of an assembly: a solid, and the pose that maps its mesh to the world.
struct Part {
  SolidBody solid;
  Pose to_world;
};

// Two parts of a list that share volume.
struct OverlappingPair {
  std::size_t first = 0, second = 0;  // their places in the list; first < second
  Overlap overlap;                    // a is the first
  // Tells why no answer is given, though the two may share volume; empty as a rule.
  std::string refusal;
};

// Returns the pairs of parts that share volume, in ascending order of `first`, then `second`, with
// what overlap() returns of each. Parts that only touch are no pair: what is no thicker on average
// than flush faces may be, 2^-34 of the larger radius and the rounding of places far from the
// origin, is nothing. Where the boundary of what two parts share does not close, their pair
// has the refusal that overlap() throws, so that it hides no others. Takes time of the contacts'
// sizes, beside n log n of the boxes about n parts; uses several threads, whose number changes no
// bit. Thread-safe. Throws as OverlapQuery does for options and bodies, and Error(refused), naming
// the part by its place, for a pose that is none.
VPM_API std::vector<OverlappingPair> overlapping_pairs(std::span<const Part> parts,
                                                       const OverlapOptions& options = {
                                                           .with_force = false});

}  // namespace vpm
