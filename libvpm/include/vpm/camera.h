// Depth cameras: pinhole model, and how normals are estimated from their images.
#pragma once

#include <vpm/pose.h>

#include <cstdint>

namespace vpm {

// Pinhole camera in pixels: x right, y down, z forward; pixel centres at integer coordinates.
struct Intrinsics {
  double fx = 0, fy = 0, cx = 0, cy = 0;
};

struct Camera {
  Intrinsics intrinsics;
  std::uint32_t width = 0, height = 0;  // pixels
  Pose to_world;                        // camera to world coordinates
};

// Axes of cameras and clouds that other programs use.
enum class CameraAxes {
  opencv,  // x right, y down, z forward: the axes of this library
  opengl,  // x right, y up, z backward
  ros      // x forward, y left, z up: a robot's body
};

// Estimators of a pixel's normal from a square window around it. inverse_depth is the least-squares
// plane of inverse depth; pca is the eigenvector of the points' covariance (section 3.1 of
// Kaluschke, Weller, Zachmann, "A Volumetric Penetration Measure for 6-DOF Haptic Rendering of
// Streaming Point Clouds", 2017).
enum class NormalMethod { inverse_depth, pca };

// Difference of inverse depth, relative to the centre's, that noise alone explains: 4 sigma of a
// Kinect at 3.5 m.
inline constexpr double kEdgeGate = 0.02;

struct NormalOptions {
  NormalMethod method = NormalMethod::inverse_depth;
  int window = 7;  // side in pixels; odd, 3 to 31
  // Relative difference of inverse depth, below 1, that is taken for an edge of the depth image; 0
  // keeps every pixel of the window.
  double edge_gate = kEdgeGate;
};

// How the refined measure reads measured points: freed of most of their noise, or as measured,
// which is ready in less time.
enum class Denoising { on, off };

}  // namespace vpm
