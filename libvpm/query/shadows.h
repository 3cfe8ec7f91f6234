// What a camera has not seen, since something hides it.
#pragma once

namespace vpm {

// What counts of it: places up to the tool's reach behind what is seen, and those further behind
// for which the surface vouches that cuts the tool (README.md, "Far places"); or all, so that V is
// that of a count of what is behind the depth image.
enum class Shadows { near, solid };

}  // namespace vpm
