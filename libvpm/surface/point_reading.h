#pragma once

namespace vpm {

// How the points of a cloud are read by the refined measure: freed of most of their noise
// (settled_image.h where a camera saw them, settled_disks.h otherwise), or as they were measured,
// which is ready in less time.
enum class PointReading { settled, as_measured };

}  // namespace vpm
