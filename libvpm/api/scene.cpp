#include <vpm/depth_stream.h>
#include <vpm/scene.h>

#include "libvpm/api/depth_images.h"
#include "libvpm/api/handle_access.h"
#include "libvpm/cloud/cloud.h"
#include "libvpm/cloud/normals.h"
#include "libvpm/cloud/scattered_points.h"
#include "libvpm/core/error.h"
#include "libvpm/core/exact_pose.h"
#include "libvpm/scene/any_body.h"
#include "libvpm/scene/depth_frames.h"
#include "libvpm/solid/placed_solid.h"

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

PointCloud PointCloud::seen_from(const Pose& camera_to_world) const {
  Cloud cloud = HandleAccess::held(*this);
  if (!cloud.sensor) refuse("the cloud keeps no camera that could be elsewhere");
  Pose& told = cloud.sensor->camera.to_world;
  const Rotation turn = camera_to_world.rotation * transpose(told.rotation);
  cloud.origin = camera_to_world.translation + turn * (cloud.origin - told.translation);
  told = camera_to_world;
  validate(cloud.sensor->camera, "the cloud");
  for (std::vector<Vec3f>* const vectors : {&cloud.positions, &cloud.normals})
    for (Vec3f& one : *vectors) one = narrow(turn * widen(one));
  return handle_of(std::move(cloud));
}

Body::Body(const PointCloud& cloud, Denoising points)
    : body_(std::make_shared<const AnyBody>(HandleAccess::held(cloud), points)) {}

Body::Body(const SolidBody& solid, const Pose& to_world)
    : solid_(std::make_shared<const PlacedSolid>(PlacedSolid{
          HandleAccess::shared(solid), exact_pose(to_world), 0, HandleAccess::model(solid)})) {
  if (!solid_->surface->has_depth())
    throw Error(ErrorKind::invalid_argument, "a solid was made without what forces need", {},
                "make it with `with_force`");
}

std::vector<DepthBody> depth_images_of(std::span<const Body> bodies) {
  std::vector<DepthBody> images;
  for (const Body& body : bodies) {
    const DepthBody* const image =
        body.is_solid() ? nullptr : HandleAccess::held(body).as<DepthBody>();
    if (image == nullptr)
      throw Error(ErrorKind::invalid_argument,
                  "a body of several cameras is made of depth images, and of nothing else");
    images.push_back(*image);
  }
  return images;
}

Body Body::of_cameras(std::span<const Body> images) {
  return HandleAccess::make<Body>(body_of_cameras(depth_images_of(images)));
}

std::size_t Body::points() const {
  return is_solid() ? 0 : HandleAccess::held(*this).points();
}

bool Body::is_solid() const {
  return HandleAccess::solid_of(*this) != nullptr;
}

Scene::Scene(const Body& body) : Scene(std::vector<Body>(1, body)) {}

Scene::Scene(std::vector<Body> bodies) {
  if (bodies.empty()) throw Error(ErrorKind::invalid_argument, "a scene needs a body");
  std::vector<AnyBody> list;
  std::vector<PlacedSolid> solids;
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    if (const PlacedSolid* const solid = HandleAccess::solid_of(bodies[k]))
      solids.emplace_back(*solid).place = k;
    else
      list.push_back(HandleAccess::held(bodies[k]));  // throws if it was moved from
  }
  bodies_ = std::make_shared<const std::vector<Body>>(std::move(bodies));
  list_ = std::make_shared<const std::vector<AnyBody>>(std::move(list));
  solids_ = std::make_shared<const std::vector<PlacedSolid>>(std::move(solids));
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
