// Prepares points without a camera for queries: all that depends on the cloud alone is computed
// once, here. Immutable; safe to share between threads.
#pragma once

#include <vpm/camera.h>

#include <vector>

#include "libvpm/scene/cloud_order.h"
#include "libvpm/scene/points/disk_surface.h"
#include "libvpm/scene/points/disk_windows.h"

namespace vpm {

// Points with their tree, their denoised disks, and the cones of the disks' normals.
class PreparedPoints {
 public:
  // Leaves out a cloud's camera, if it has one. Throws what check_for_queries() throws. Denoising
  // 300 000 points takes a core a second or two.
  explicit PreparedPoints(const Cloud& cloud, Denoising points = Denoising::on);

  // Returns a number shared by copies of the points only.
  std::uint64_t serial() const { return serial_; }
  // Returns the surface of the points' disks, about origin().
  DiskSurface surface() const;
  const DenoisedDisks& disks() const { return disks_; }  // in the order of positions()
  const DiskDipoles& dipoles() const { return dipoles_; }
  // Returns how many points were left out, since the others enclose them: they are of inner faces.
  std::size_t inner() const { return inner_; }

  // Return the points about origin(), and their normals, world axes, in the order of the leaves of
  // their tree.
  Vec3 origin() const { return points_.origin; }
  const std::vector<Vec3f>& positions() const { return points_.positions; }
  const std::vector<Vec3f>& normals() const { return points_.normals; }
  PointTree point_tree() const;  // tree of the positions

  // Calls visit(begin, end) for ranges that hold all points in the ball about origin(), and others.
  template <class Visit>
  void for_ranges_in_ball(Vec3 center, double radius, const Visit& visit) const {
    point_tree().for_leaves_in_ball(center, radius * radius,
                                    [&](std::uint32_t begin, std::uint32_t end) {
                                      visit(begin, end);
                                      return true;
                                    });
  }
  // Returns a bound of the number of ranges in a ball.
  std::size_t most_ranges() const { return leaves_for(positions().size()); }

 private:
  // Return indices of the cloud's points, each place and normal once, in the order of positions();
  // and, having taken the points in such an order, their windows.
  static std::vector<std::uint32_t> order_in_space(const Cloud& cloud);
  bool leaves_out_inner(const Cloud& cloud, std::vector<std::uint32_t>& order);
  DiskWindows take(const Cloud& cloud, const std::vector<std::uint32_t>& order);

  std::uint64_t serial_ = next_serial();
  OrderedPoints points_;
  std::vector<BoxQuad> boxes_;        // bounds of the positions
  std::vector<float> largest_radii_;  // largest radius of a disk in each tree node
  std::vector<BoxQuad> foot_boxes_;   // bounds of the disks' feet, unless those are the positions
  DenoisedDisks disks_;
  DiskDipoles dipoles_;
  std::size_t inner_ = 0;
  std::vector<ConeQuad> cones_;  // cones of the disks' normals
};

}  // namespace vpm
