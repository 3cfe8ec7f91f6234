#include "libvpm/setup/cloud_checks.h"

#include <utility>

#include "libvpm/setup/size_check.h"

namespace vpm {

CloudChecks::CloudChecks(std::vector<const ToolModel*> tools, const Cloud& cloud,
                         std::optional<DepthSurface> measured)
    : tools_(std::move(tools)),
      scene_(checked_scene(cloud)),
      sizes_(improbable_sizes(tools_, scene_, false)),
      poses_(tools_, source_of(cloud), [this](std::size_t) { return scene_; }) {
  if (sizes_) return;
  if (!cloud.sensor) enclosed_.emplace(tools_, cloud);
  if (cloud.sensor && measured) measured_.emplace(tools_, *measured, *cloud.sensor);
}

void CloudChecks::see(const Pose& pose, std::size_t k, const Result& result) {
  if (sizes_) return;
  poses_.see(pose, k, result);
  if (measured_) measured_->see(pose, k);
  if (enclosed_) enclosed_->see(pose, k, result);
}

Remarks CloudChecks::remarks() const {
  if (sizes_) return {*sizes_};
  if (enclosed_)
    if (const std::optional<Remark> inside = enclosed_->remark()) return {*inside};
  const MeasuredCheck::Found found = measured_ ? measured_->found() : MeasuredCheck::Found{};
  const std::optional<Remark> unmeasured = measured_ ? measured_->remark(found) : std::nullopt;
  // Poses that miss the scene may lie behind some of its holes by chance.
  if (unmeasured && 2 * found.unmeasured >= found.poses) return {*unmeasured};
  if (const std::optional<Remark> missing = poses_.remark()) return {*missing};
  return unmeasured ? Remarks{*unmeasured} : Remarks{};
}

}  // namespace vpm
