// Surface normals of a depth image, and the cloud made of both.
//
// Two estimators over a square window around each pixel:
// - inverse_depth (default): least-squares plane of inverse depth, 1/z = a u + b v + c. A plane in
//   space is affine there, and a sensor's noise lies along the ray, so this is the linear
//   regression whose error model is the sensor's; it needs sums only, no eigenvector.
// - pca: eigenvector of the smallest eigenvalue of the points' covariance (section 3.1 of
//   Kaluschke, Weller, Zachmann, "A Volumetric Penetration Measure for 6-DOF Haptic Rendering of
//   Streaming Point Clouds", 2017).
// Both leave out of a window what lies across a depth edge, seen from its centre: where something
// differs from the centre's inverse depth by more than the edge gate, what is further than that
// from the centre's surface. Windows without such an edge keep all that was measured. What the
// image's border leaves of a window is a window too.
//
// The same input gives the same bits for any number of threads and any IEEE compiler; depth scaled
// by a power of two gives the same normals. Of a part of an image, pca's last bits are the same if
// the part begins at an even column.
#pragma once

#include <string>
#include <vector>

#include "libvpm/cloud/cloud.h"
#include "libvpm/cloud/normal_limits.h"

namespace vpm {

enum class NormalMethod { inverse_depth, pca };

// "inverse-depth", "pca"; the second throws Error(usage) for any other text.
std::string to_text(NormalMethod method);
NormalMethod normal_method_from_text(const std::string& text);

struct NormalOptions {
  NormalMethod method = NormalMethod::inverse_depth;
  int window = 7;                // side in pixels, odd
  double edge_gate = kEdgeGate;  // 0 < gate < 1; 0 keeps every pixel of the window
};

// Throw Error(usage) where a value is out of range.
void check_normal_options(const NormalOptions& options);
void check_intrinsics(const Intrinsics& intrinsics);

// One unit normal per pixel, row by row, in camera coordinates and towards the sensor; zero where
// nothing was measured or too little of the window remains (normal_limits.h). Throws
// Error(usage) for options out of range, Error(refused) for an image whose size does not fit.
std::vector<Vec3f> estimate_normals(const DepthImage& depth, const Intrinsics& intrinsics,
                                    const NormalOptions& options);

// The points of the pixels that have a normal, about the camera's position, in pixel order. A
// point's radius is half the diagonal of its pixel's footprint on the tangent plane, so the disks
// of neighbouring pixels overlap.
Cloud assemble_cloud(const DepthImage& depth, const Camera& camera,
                     const std::vector<Vec3f>& normals);

// Both of the above.
Cloud make_cloud(const DepthImage& depth, const Camera& camera, const NormalOptions& options);

}  // namespace vpm
