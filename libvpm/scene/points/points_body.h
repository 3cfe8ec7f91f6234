// Defines PointsBody, a body of a scene that is made of points without a camera.
#pragma once

#include <cstddef>
#include <memory>

#include "libvpm/scene/points/disk_surface.h"
#include "libvpm/scene/points/prepared_points.h"

namespace vpm {
namespace cuda {
class DevicePointsBody;
}

// Handle of immutable points that are ready for queries; copies share them. Thread-safe.
class PointsBody {
 public:
  using Surface = DiskSurface;
  using OnDevice = cuda::DevicePointsBody;

  // Prepares a cloud, of which a camera is left out. Throws what PreparedPoints throws.
  explicit PointsBody(const Cloud& cloud, Denoising points = Denoising::on)
      : points_(std::make_shared<const PreparedPoints>(cloud, points)),
        to_world_{{}, points_->origin()} {}

  // Returns what maps the surface's frame, which is about the points' origin, to the world's.
  const Pose& to_world() const { return to_world_; }
  std::size_t points() const { return points_->positions().size(); }
  const PreparedPoints& prepared() const { return *points_; }
  DiskSurface surface() const { return points_->surface(); }
  std::uint64_t serial() const { return points_->serial(); }

 private:
  std::shared_ptr<const PreparedPoints> points_;
  Pose to_world_;
};

}  // namespace vpm
