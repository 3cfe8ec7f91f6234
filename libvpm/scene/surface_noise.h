// Sums by how much noise of what was measured moves a volume that a body's surface bounds
// (measure/README.md, Intervals). Each place where the surface cuts the tool adds its part. Host
// only; a sum refers to its surface and belongs to one thread.
#pragma once

#include <array>

#include "libvpm/scene/depth/depth_surface.h"
#include "libvpm/scene/points/disk_surface.h"
#include "libvpm/scene/rig/rig_surface.h"

namespace vpm {

// A sum's members:
//   tells()            false if nothing can be known of the noise
//   add(at, area)      adds an area, m^2, of the surface about a sampled place
//   variance()         returns the variance of the volume, m^6
template <class Surface>
class NoiseSum;

// Of pixels that err each by itself: what a pixel adds is its deviation along its ray times its
// width and height, whichever way the surface faces. The deviation is that of second differences of
// neighbours, which a plane leaves 0.
template <>
class NoiseSum<DepthSurface> {
 public:
  explicit NoiseSum(const DepthSurface& surface) : surface_(surface) {}

  static constexpr bool tells() { return true; }
  void add(const SurfaceSample& at, double area) { variance_ += area * per_area(at); }
  double variance() const { return variance_; }

  // Returns what an area about a place adds to the variance, per m^2, m^4.
  double per_area(const SurfaceSample& at) const;

 private:
  const DepthSurface& surface_;
  double variance_ = 0;
};

// Of disks: by how far points were measured from the disks that denoising made of them.
template <>
class NoiseSum<DiskSurface> {
 public:
  explicit NoiseSum(const DiskSurface& surface) : surface_(surface) {}

  bool tells() const { return surface_.measured != nullptr; }
  void add(const SurfaceSample& at, double area);
  double variance() const { return variance_; }

 private:
  const DiskSurface& surface_;
  double variance_ = 0;
};

// Of several cameras: each one's pixels by the weights of their mean, and by how much the cameras
// disagree over all of the area, which their noise leaves but wrong poses do not.
template <>
class NoiseSum<RigSurface> {
 public:
  explicit NoiseSum(const RigSurface& surface) : surface_(surface) {}

  static constexpr bool tells() { return true; }
  void add(const SurfaceSample& at, double area);
  double variance() const;

 private:
  const RigSurface& surface_;
  double of_pixels_ = 0;                                         // m^6
  std::array<double, RigSurface::kMostCameras> disagreement_{};  // m^3, of each camera
};

}  // namespace vpm
