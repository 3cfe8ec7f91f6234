// Lists the kinds of bodies that a scene is made of. A new kind is a class with the members of
// BodyKind, for its surface what body.h asks, and one entry here; the CPU visits a body by its
// kind, and so does a device (cuda/device_bodies.h).
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

#include "libvpm/cloud/cloud.h"
#include "libvpm/scene/body.h"
#include "libvpm/scene/depth/depth_body.h"
#include "libvpm/scene/points/points_body.h"
#include "libvpm/scene/rig/rig_body.h"

namespace vpm {

// A kind of body is a handle: cheap to copy, immutable, thread-safe. Its members:
//   Surface          what the measure asks (MeasuredBody), in the body's own frame
//   to_world()       maps that frame to the world's
//   surface()        the surface on the host
//   prepared()       the measured points: origin(), positions(), normals() and for_ranges_in_ball()
//   points()         their number
//   serial()         a number that no other body has; 0 for a frame that is on a device only
//   OnDevice         its copy in the memory of a device, made of prepared() (cuda/device_bodies.h)
template <class B>
concept BodyKind = std::copyable<B> && MeasuredBody<typename B::Surface> &&
    requires(const B& body) {
  { body.to_world() } -> std::convertible_to<Pose>;
  { body.surface() } -> std::same_as<typename B::Surface>;
  { body.points() } -> std::same_as<std::size_t>;
  { body.prepared().serial() } -> std::same_as<std::uint64_t>;
  { body.serial() } -> std::same_as<std::uint64_t>;
  typename B::OnDevice;
};

template <BodyKind... Kind>
struct KindsOfBody {
  using Held = std::variant<Kind...>;
  // Holds an Each<> of every kind, or of every kind's surface.
  template <template <class> class Each>
  using Tuple = std::tuple<Each<Kind>...>;
  template <template <class> class Each>
  using OfSurfaces = std::tuple<Each<typename Kind::Surface>...>;
  // Makes the latter, each from the same argument.
  template <template <class> class Each, class Argument>
  static OfSurfaces<Each> of_surfaces(const Argument& argument) {
    return {Each<typename Kind::Surface>(argument)...};
  }
  template <class B>
  static constexpr bool kHas = (std::same_as<B, Kind> || ...);
};
// The one list of kinds.
using BodyKinds = KindsOfBody<DepthBody, PointsBody, RigBody>;

// Handle of a body of any kind.
class AnyBody {
 public:
  template <class Kind>
  requires(BodyKinds::kHas<Kind>) AnyBody(Kind body) : held_(std::move(body)) {}
  // Prepares a cloud: as its depth image if it keeps one, else as points. Throws what they throw.
  explicit AnyBody(const Cloud& cloud, Denoising points = Denoising::on)
      : held_(cloud.sensor ? Held(DepthBody(cloud, points)) : Held(PointsBody(cloud, points))) {}

  // Returns what visit(body) returns for the body by its kind.
  template <class Visit>
  decltype(auto) visit(Visit&& visit) const {
    return std::visit(std::forward<Visit>(visit), held_);
  }
  // Returns the body if it is of this kind, else null.
  template <class Kind>
  const Kind* as() const {
    return std::get_if<Kind>(&held_);
  }

  const Pose& to_world() const {
    return visit([](const auto& body) -> const Pose& { return body.to_world(); });
  }
  // Returns the number of measured points with a normal; waits for a frame that is being prepared.
  std::size_t points() const {
    return visit([](const auto& body) { return body.points(); });
  }
  std::uint64_t serial() const {
    return visit([](const auto& body) { return body.serial(); });
  }
  // True if places behind the surface are inside as far as anybody knows.
  bool tells_inside() const {
    return visit([](const auto& body) {
      return std::remove_cvref_t<decltype(body)>::Surface::kTellsInside;
    });
  }

  // Return the measured points about origin() and their normals, world axes. A frame of a device is
  // prepared on the host first.
  Vec3 origin() const {
    return visit([](const auto& body) { return body.prepared().origin(); });
  }
  const std::vector<Vec3f>& positions() const {
    return visit([](const auto& body) -> const auto& { return body.prepared().positions(); });
  }
  const std::vector<Vec3f>& normals() const {
    return visit([](const auto& body) -> const auto& { return body.prepared().normals(); });
  }

 private:
  using Held = BodyKinds::Held;
  Held held_;
};

// Returns the one body that images of several cameras are (rig/); one image alone is itself. Throws
// what PreparedRig throws.
inline AnyBody body_of_cameras(std::vector<DepthBody> images) {
  std::vector<DepthBody> different = different_images(std::move(images));
  return different.size() == 1 ? AnyBody(different.front())
                               : AnyBody(RigBody(std::move(different)));
}

}  // namespace vpm
