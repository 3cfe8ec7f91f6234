// What a normal needs: limits that host and devices share.
#pragma once

namespace vpm {

inline constexpr int kMinWindow = 3, kMaxWindow = 31;

// Fewest pixels of a window, and least spread (variance in px^2 along the narrowest direction:
// two neighbouring diagonals have 1/8), that still tell a plane's two slopes.
inline constexpr int kMinSupport = 6;
inline constexpr float kMinSpread = 0.1F;

// Difference of inverse depth, as a fraction of the centre's, that noise alone explains: 4 sigma of
// a Kinect at 3.5 m.
inline constexpr double kEdgeGate = 0.02;

// Depths outside of this range have no inverse that float holds well; they get no normal.
inline constexpr float kMinDepth = 0x1p-80F, kMaxDepth = 0x1p80F;

}  // namespace vpm
