// From a mesh to a tool: reading, packing with spheres, levels of detail. Library vpm::solid.
//
//   const vpm::SolidMesh mesh = vpm::SolidMesh::read("gripper.stl", {.scale = 0.001});
//   const vpm::Tool tool = vpm::build_tool(vpm::pack(mesh, {.spheres = 1000}), {.levels = {250}});
//
// All functions are thread-safe and use several threads inside; the same input gives the same
// bytes, for any number of threads.
#pragma once

#include <vpm/error.h>
#include <vpm/pose.h>
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
struct HandleAccess;  // the library's own
struct Packing;       // the library's own

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

  // Returns the volume that is enclosed at least once, m^3.
  double volume() const;
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

}  // namespace vpm
