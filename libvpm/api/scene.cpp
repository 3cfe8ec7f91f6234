#include <vpm/depth_stream.h>
#include <vpm/scene.h>

#include "libvpm/api/handle_access.h"
#include "libvpm/cloud/cloud.h"
#include "libvpm/cloud/normals.h"
#include "libvpm/cloud/scattered_points.h"
#include "libvpm/core/error.h"
#include "libvpm/scene/any_body.h"
#include "libvpm/scene/depth_frames.h"

namespace vpm {
namespace {

PointCloud handle_of(Cloud cloud) {
  return HandleAccess::make<PointCloud>(std::move(cloud));
}

}  // namespace

PointCloud PointCloud::read(const std::string& path) {
  return handle_of(read_cloud(path));
}

PointCloud PointCloud::from_depth(std::span<const float> depth, const Camera& camera,
                                  const NormalOptions& options) {
  check_normal_options(options);
  check_intrinsics(camera.intrinsics);
  validate(camera, "the depth image");
  const DepthImage image{camera.width, camera.height, {depth.begin(), depth.end()}};
  Cloud cloud = make_cloud(image, camera, options);
  if (cloud.size() == 0) refuse("no pixel has a normal", "the depth image");
  return handle_of(std::move(cloud));
}

PointCloud PointCloud::from_points(std::span<const Vec3> positions, std::span<const Vec3> normals) {
  if (positions.size() != normals.size())
    throw Error(ErrorKind::invalid_argument,
                std::to_string(positions.size()) + " positions, but " +
                    std::to_string(normals.size()) + " normals",
                "the points");
  return handle_of(cloud_of_scattered_points({positions.begin(), positions.end()},
                                             {normals.begin(), normals.end()}, Pose{},
                                             "the points"));
}

void PointCloud::write(const std::string& path) const {
  write_cloud(path, HandleAccess::held(*this));
}

std::size_t PointCloud::size() const {
  return HandleAccess::held(*this).size();
}

std::optional<Camera> PointCloud::camera() const {
  const Cloud& cloud = HandleAccess::held(*this);
  return cloud.sensor ? std::optional(cloud.sensor->camera) : std::nullopt;
}

Body::Body(const PointCloud& cloud, Denoising points)
    : body_(std::make_shared<const AnyBody>(HandleAccess::held(cloud), points)) {}

std::size_t Body::points() const {
  return HandleAccess::held(*this).points();
}

Scene::Scene(const Body& body) : Scene(std::vector<Body>(1, body)) {}

Scene::Scene(std::vector<Body> bodies) {
  if (bodies.empty()) throw Error(ErrorKind::invalid_argument, "a scene needs a body");
  std::vector<AnyBody> list;
  for (const Body& body : bodies)
    list.push_back(HandleAccess::held(body));  // throws if it was moved from
  bodies_ = std::make_shared<const std::vector<Body>>(std::move(bodies));
  list_ = std::make_shared<const std::vector<AnyBody>>(std::move(list));
}

const std::vector<Body>& Scene::bodies() const {
  return held_by(bodies_, "Scene");
}

struct DepthStream::Impl {
  DepthFrames frames;
};

DepthStream::DepthStream(const DepthStreamOptions& options) {
  DepthFrameOptions frames;
  frames.intrinsics = options.intrinsics;
  frames.width = options.width;
  frames.height = options.height;
  frames.counts_per_metre = options.counts_per_metre;
  frames.normals = options.normals;
  frames.device = options.device;
  frames.points = options.points;
  impl_ = std::make_unique<Impl>(Impl{DepthFrames(frames)});
}
DepthStream::~DepthStream() = default;
DepthStream::DepthStream(DepthStream&&) noexcept = default;
DepthStream& DepthStream::operator=(DepthStream&&) noexcept = default;

DepthStream::Impl& DepthStream::impl() const {
  return held_by(impl_, "DepthStream");
}

std::span<std::uint16_t> DepthStream::counts() {
  return impl().frames.counts();
}

std::span<float> DepthStream::metres() {
  return impl().frames.metres();
}

Body DepthStream::prepare(const Pose& camera_to_world) {
  return HandleAccess::make<Body>(AnyBody(impl().frames.prepare(camera_to_world)));
}

}  // namespace vpm
