// The tool whose penetration is measured: a solid packed with spheres, at several levels of detail.
#pragma once

#include <vpm/error.h>
#include <vpm/export.h>
#include <vpm/pose.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace vpm {

struct HandleAccess;  // the library's own
struct ToolModel;     // the library's own

// Level of detail: the largest spheres of the packing, with what the rest of the solid's volume
// adds to each. Errors are fractions of the solid's volume over cuts by planes and balls at all
// depths; absent if the model is not calibrated.
struct ToolLevel {
  std::uint32_t spheres = 0;
  std::optional<double> mean_error, worst_error;
};

// Handle of an immutable tool model; copies share it. Frame: the mesh's own coordinates, m.
// Thread-safe: any number of threads may use one tool at once.
class VPM_API Tool {
 public:
  // Reads a .vpmg file (formats/tool-model.md) whole and checks every number in it; "-" is standard
  // input. Throws Error(refused) naming the file and the first defect.
  static Tool read(const std::string& path);

  // Writes a .vpmg file, replacing it in one step; "-" is standard output. The same tool gives the
  // same bytes. Throws Error(cannot_write).
  void write(const std::string& path) const;

  // Returns the volume of the solid, m^3.
  double volume() const;
  // Returns the centre of mass of the homogeneous solid, about which torques are measured.
  Vec3 center_of_mass() const;
  // Returns the tool radius: the largest distance of a point of the solid from the centre of mass,
  // m.
  double radius() const;
  // Returns the radius of gyration, m, of a ball with the solid's mean moment of inertia, for
  // CouplingParameters.
  double gyration() const;
  // Returns all spheres, largest first; a level of n spheres uses the first n.
  std::vector<Sphere> spheres() const;
  // Returns the levels of detail, coarsest first; at least one.
  std::vector<ToolLevel> levels() const;

 private:
  friend HandleAccess;
  explicit Tool(std::shared_ptr<const ToolModel> model) : model_(std::move(model)) {}

  std::shared_ptr<const ToolModel> model_;  // null once moved from
};

}  // namespace vpm
