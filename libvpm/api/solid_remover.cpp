#include <vpm/scene.h>
#include <vpm/solid.h>

#include <memory>
#include <utility>
#include <vector>

#include "libvpm/api/handle_access.h"
#include "libvpm/cloud/cloud.h"
#include "libvpm/core/error.h"
#include "libvpm/core/handle.h"
#include "libvpm/solid/depth_remover.h"

namespace vpm {
namespace {

std::unique_ptr<DepthRemover> remover_of(std::span<const SolidBody> solids) {
  std::vector<std::shared_ptr<const SolidSurface>> surfaces;
  for (const SolidBody& solid : solids) surfaces.push_back(HandleAccess::shared(solid));
  return std::make_unique<DepthRemover>(surfaces);
}

}  // namespace

SolidRemover::SolidRemover(std::span<const SolidBody> solids) : impl_(remover_of(solids)) {}
SolidRemover::~SolidRemover() = default;
SolidRemover::SolidRemover(SolidRemover&&) noexcept = default;
SolidRemover& SolidRemover::operator=(SolidRemover&&) noexcept = default;

DepthRemover& SolidRemover::impl() const {
  return held_by(impl_, "SolidRemover");
}

std::size_t SolidRemover::remove(std::span<const SolidPlace> places, const Camera& camera,
                                 std::span<float> depth) {
  return impl().remove(places, camera, depth);
}

PointCloud SolidRemover::remove(std::span<const SolidPlace> places, const PointCloud& cloud) {
  Cloud rest = HandleAccess::held(cloud);
  if (!rest.sensor)
    refuse("the cloud keeps no depth image, from which solids can be removed", "the cloud",
           "make it of the depth image");
  impl().remove(places, rest.sensor->camera, rest.sensor->depth.depth);
  return HandleAccess::make<PointCloud>(without_removed(std::move(rest)));
}

const std::vector<RemovedSolid>& SolidRemover::found() const {
  return impl().found();
}

}  // namespace vpm
