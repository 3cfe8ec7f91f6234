// Measures a tool against the solids of a scene, by the surfaces of tool and solids or by their
// spheres (libvpm/solid).
#pragma once

#include <vpm/query_types.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "libvpm/measure/body_sum.h"
#include "libvpm/model/tool_model.h"
#include "libvpm/query/contact_list.h"
#include "libvpm/solid/placed_solid.h"
#include "libvpm/solid/solid_pair.h"
#include "libvpm/solid/sphere_pair.h"

namespace vpm {

// The solids of a scene, and where they are when it is asked.
struct SolidsAt {
  std::span<const PlacedSolid> solids;
  std::span<const Pose> poses;  // of each, mesh to world; none: where the solids say

  const Pose& pose(std::size_t k) const { return poses.empty() ? solids[k].to_world : poses[k]; }
  // Returns the place in the scene's list of the k-th body that is no solid.
  std::size_t place_of_other(std::size_t k) const {
    for (const PlacedSolid& solid : solids) k += solid.place <= k;  // solids are in their order
    return k;
  }
};

// What one solid gives.
struct SolidAnswer {
  BodySum body;
  std::optional<double> closure;  // SharedSolid::closure; spheres have none
  std::vector<ContactPatch> contacts;
};

// Refers to its tool, which must outlive it. Belongs to one thread.
class SolidQuery {
 public:
  explicit SolidQuery(const ToolModel& tool) : tool_(tool) {}

  // Makes one for another thread, which shares the tool's surface.
  SolidQuery(const SolidQuery& other) : tool_(other.tool_), surface_(other.surface_) {}

  // Prepares the tool's surface, if that is not done. Throws Error(refused) if the tool keeps none.
  void prepare();

  // Takes the surface that another query of the same tool has prepared, if this one has none.
  void share_surface_of(const SolidQuery& other) {
    if (!surface_) surface_ = other.surface_;
  }

  // Returns what the k-th solid gives for the tool at a pose, in the tool's axes and units: the
  // volume to rounding, since all of it is rounded to 2^-60 of the tool. `states` receives that of
  // each of the largest spheres. Finds the `contacts` largest contacts, and the sum of all others,
  // as wrenches without stiffness; none for 0. Throws what prepare() throws, and Error(refused) if
  // the shared boundary does not close.
  SolidAnswer run(const SolidsAt& solids, std::size_t k, const Pose& pose,
                  std::span<SphereState> states, std::uint32_t contacts = 0);

 private:
  struct Pair {
    std::shared_ptr<const SolidSurface> other;
    SolidPair pair;
  };

  SolidPair& pair_with(const PlacedSolid& solid, std::size_t k);
  std::vector<ContactPatch> patches_of(const SharedSolid& shared, const Pose& pose,
                                       std::size_t body) const;

  const ToolModel& tool_;
  std::shared_ptr<const SolidSurface> surface_;  // null before the first call
  std::vector<std::optional<Pair>> pairs_;       // by the solids' places
};

// Measures a tool against the solids of a scene by the spheres of tool and solids, as the measure
// as printed does. Keeps a reference to its tool.
class SphereQuery {
 public:
  SphereQuery(const ToolModel& tool, const Level& level) : tree_{tool, level} {}

  // Returns what SolidQuery::run() does, but for the contacts. Takes all spheres of the solid,
  // which must have a model.
  SolidAnswer run(const SolidsAt& solids, std::size_t k, const Pose& pose,
                  std::span<SphereState> states);

 private:
  InnerSphereTree tree_;
  SpherePair pair_;
};

// Returns the surface of a tool, prepared. Throws Error(refused) if the tool keeps none.
std::shared_ptr<const SolidSurface> prepared_surface(const ToolModel& tool, bool with_depth);

}  // namespace vpm
