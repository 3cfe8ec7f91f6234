// Takes the pixels of a depth image that known solids explain out of it, before it is a body: the
// robot in its own picture is no obstacle.
//
// Let m be a solid's margin: no point of its surface was further than m from where its pose says.
// A pixel is removed if
// - the solid, where its pose says, meets the pixel's square, and the pixel was not measured before
//   it by more than m. What was measured behind it tells a pose that is off by more than m, or a
//   mixed pixel; nobody has seen the solid's own place to be free;
// - some place within m of the solid's surface is in the pixel, and the depth measured there lies
//   in the range of these places, or none was measured there;
// - it is next to a removed one, and was not measured before it: cameras mix the depths on either
//   side of a silhouette; or it is next to one of these, and alone with its depth.
// Depths are compared with what noise alone explains (kEdgeGate) beside m. libvpm/solid/README.md
// has the reasons.
#pragma once

#include <vpm/camera.h>
#include <vpm/scene.h>

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "libvpm/cloud/cloud.h"
#include "libvpm/solid/solid_image.h"

namespace vpm {

// Belongs to one thread.
class DepthRemover {
 public:
  explicit DepthRemover(std::span<const std::shared_ptr<const SolidSurface>> solids);

  std::size_t solids() const { return solids_.size(); }
  // Marks the pixels as removed (kRemovedDepth) and returns the number of those that had been
  // measured. The order of solids changes no bit. Throws Error(invalid_argument) unless there is a
  // place for each solid with a margin that is finite and not negative; Error(refused) for a pose
  // or a camera that is none, or an image of another size.
  std::size_t remove(std::span<const SolidPlace> places, const Camera& camera,
                     std::span<float> depth);
  // Returns what the last image told of each solid.
  const std::vector<RemovedSolid>& found() const { return found_; }

 private:
  void remove_solid(std::size_t k, const Pose& to_camera, double margin, const Camera& camera,
                    std::span<float> depth);
  // Calls take_row(ranges, count, margin, depth, limits) for each row of a window.
  template <class TakeRow>
  void take_rows(const PixelWindow& seen, double margin, std::span<float> depth,
                 const TakeRow& take_row);
  void take_nearer(double depth_limit, std::span<const float> depth);
  std::size_t mark(std::span<float> depth);
  bool is_alone(int u, int v, std::span<const float> depth) const;
  std::vector<std::size_t> beside_removed_alone(std::span<const float> depth) const;

  std::vector<std::shared_ptr<const SolidSurface>> surfaces_;
  std::vector<DrawnSolid> solids_;
  SolidImage image_;
  PixelWindow whole_, changed_;  // the image, and what of limits_ is not infinite
  // Depth from which on a pixel is explained, m, with its neighbours.
  std::vector<float> limits_;
  std::vector<RemovedSolid> found_;
};

}  // namespace vpm
