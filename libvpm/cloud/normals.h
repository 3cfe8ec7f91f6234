// Surface normals of a depth image, and the cloud made of both.
//
// Two estimators work on a square window around each pixel:
// - inverse_depth (default): least-squares plane of inverse depth, 1/z = a u + b v + c. Planes in
//   space are affine in inverse depth, and a sensor's noise lies along the ray, so this regression
//   has the sensor's error model; it needs sums only, no eigenvector.
// - pca: eigenvector of the smallest eigenvalue of the points' covariance (section 3.1 of
//   Kaluschke, Weller, Zachmann, "A Volumetric Penetration Measure for 6-DOF Haptic Rendering of
//   Streaming Point Clouds", 2017).
//
// Both exclude pixels across a depth edge: if the inverse depth of some pixel differs from the
// centre's by more than the edge gate, all pixels further than that from the centre's surface are
// left out. Windows without such an edge keep all measured pixels. At the image's border a window
// is what remains of it inside the image.
//
// The same input gives the same bits for any number of threads and any IEEE compiler. Depth scaled
// by a power of two gives the same normals. A crop of an image gives the same pca normals to the
// last bit if it begins at an even column.
#pragma once

#include <string>
#include <vector>

#include "libvpm/cloud/cloud.h"

namespace vpm {

// "inverse-depth" or "pca". Parsing another text throws Error(invalid_argument).
std::string to_text(NormalMethod method);
NormalMethod normal_method_from_text(const std::string& text);

// Throw Error(invalid_argument) if a value is out of range.
void check_normal_options(const NormalOptions& options);
void check_intrinsics(const Intrinsics& intrinsics);

// Returns one unit normal per pixel, row by row, in camera coordinates and towards the sensor; zero
// where the pixel is unmeasured or too little of its window remains (window_span.h). Throws
// Error(invalid_argument) for options out of range, Error(refused) for an image whose size does not
// match.
std::vector<Vec3f> estimate_normals(const DepthImage& depth, const Intrinsics& intrinsics,
                                    const NormalOptions& options);

// Returns the points of all pixels that have a normal, in pixel order, relative to the camera's
// position. A point's radius is half the diagonal of its pixel's footprint on the tangent plane, so
// disks of neighbouring pixels overlap.
Cloud assemble_cloud(const DepthImage& depth, const Camera& camera,
                     const std::vector<Vec3f>& normals);

// Estimates normals and assembles the cloud.
Cloud make_cloud(const DepthImage& depth, const Camera& camera, const NormalOptions& options);

}  // namespace vpm
