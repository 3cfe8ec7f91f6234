#include <vpm/setup_check.h>

#include <optional>
#include <string>
#include <vector>

#include "libvpm/api/depth_images.h"
#include "libvpm/api/handle_access.h"
#include "libvpm/core/error.h"
#include "libvpm/scene/depth/depth_body.h"
#include "libvpm/setup/cameras_check.h"
#include "libvpm/setup/cloud_checks.h"
#include "libvpm/setup/registration.h"

namespace vpm {
namespace {

std::vector<const ToolModel*> models_of(const std::vector<Tool>& tools) {
  std::vector<const ToolModel*> models;
  for (const Tool& tool : tools) models.push_back(&HandleAccess::held(tool));
  if (models.empty()) throw Error(ErrorKind::invalid_argument, "a check needs a tool");
  return models;
}

// Prepares a depth image; nothing for points, or for another measure.
std::optional<DepthBody> image_of(const Cloud& cloud, Measure measure) {
  if (!cloud.sensor || measure != Measure::refined) return std::nullopt;
  return DepthBody(cloud);
}

std::optional<DepthSurface> surface_of(const std::optional<DepthBody>& image) {
  return image ? std::optional(image->surface()) : std::nullopt;
}

}  // namespace

struct SetupCheck::Impl {
  Impl(std::span<const Tool> handles, const PointCloud& cloud, Measure measure)
      : tools(handles.begin(), handles.end()),
        image(image_of(HandleAccess::held(cloud), measure)),
        checks(models_of(tools), HandleAccess::held(cloud), surface_of(image)) {}

  std::vector<Tool> tools;  // the checks refer to their models
  std::optional<DepthBody> image;
  CloudChecks checks;
};

SetupCheck::SetupCheck(const Tool& tool, const PointCloud& cloud, Measure measure)
    : SetupCheck(std::span<const Tool>(&tool, 1), cloud, measure) {}
SetupCheck::SetupCheck(std::span<const Tool> tools, const PointCloud& cloud, Measure measure)
    : impl_(std::make_unique<Impl>(tools, cloud, measure)) {}
SetupCheck::~SetupCheck() = default;
SetupCheck::SetupCheck(SetupCheck&&) noexcept = default;
SetupCheck& SetupCheck::operator=(SetupCheck&&) noexcept = default;

SetupCheck::Impl& SetupCheck::impl() const {
  return held_by(impl_, "SetupCheck");
}

void SetupCheck::see(const Pose& pose, const Result& result, std::size_t tool) {
  if (tool >= impl().tools.size())
    throw Error(ErrorKind::invalid_argument, "the check has no tool " + std::to_string(tool));
  impl().checks.see(pose, tool, result);
}

Remarks SetupCheck::remarks() const {
  return impl().checks.remarks();
}

std::optional<DoubtedCamera> doubted_camera(std::span<const Body> images) {
  return check_cameras(depth_images_of(images));
}

std::optional<Remark> uncertain_thickness(std::span<const Body> images) {
  return check_thickness(depth_images_of(images));
}

Registration register_cameras(std::span<const Body> images) {
  return register_images(depth_images_of(images));
}

}  // namespace vpm
