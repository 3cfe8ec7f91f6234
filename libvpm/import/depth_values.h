// Makes metres along the optical axis of the values that a depth image's file holds.
#pragma once

#include <cmath>
#include <optional>
#include <vector>

#include "libvpm/cloud/camera.h"
#include "libvpm/cloud/depth_image.h"
#include "libvpm/import/depth_files.h"

namespace vpm {

// How 16-bit values are coded, undone in this order.
struct DepthDecoding {
  bool swapped = false;     // the two bytes stand in the other order than the format says
  bool big_endian = false;  // a PGM's bytes stand as its standard says; if false, the values tell
  bool rotated = false;     // rotated by three bits to the left (SUN3D, Princeton's APC data)
  bool disparity =
      false;  // raw disparity of a Kinect: 351.3 / (1092.5 - value) metres (NYU Depth V2)
};

// Parses "swapped", "big-endian", "rotated", "disparity", or several with commas. Throws
// Error(invalid_argument), also for both orders of bytes.
DepthDecoding decoding_from_text(const std::string& text);

// Tells what the values of a depth image mean, where that differs from what is usual.
struct DepthReading {
  std::optional<double> units_per_metre = {};  // if unset, 1000 for integers and 1 for floats
  std::vector<double> invalid = {};            // values of the file that mean "not measured"
  bool has_usual_markers = true;               // 65535, 65504, 1e10 and the largest float do too
  double nearest = 0, farthest = HUGE_VAL;     // m: other depths count as not measured
  bool along_ray = false;  // values are distances along the ray, not along the optical axis
  DepthDecoding decoding = {};
  bool looks_for_mistakes = true;  // warns about values that look coded or like markers
};

// Returns the depth in metres, 0 where nothing was measured. Appends remarks on markers, and on
// values that look as if they were coded otherwise. Throws Error(invalid_argument) for a decoding
// of values that have not 16 bits. Sets *look_coded, if given, to whether values were said to look
// coded.
DepthImage depth_in_metres_of(const RawDepth& raw, const Intrinsics& intrinsics,
                              const DepthReading& reading, const std::string& name,
                              Remarks& remarks, bool* look_coded = nullptr);

}  // namespace vpm
