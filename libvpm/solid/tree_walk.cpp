#include "libvpm/solid/tree_walk.h"

namespace vpm {
namespace {

using Float4 = SurfaceTree::Float4;
using Int4 = std::int32_t __attribute__((vector_size(16)));

[[gnu::always_inline]] inline Float4 magnitude(Float4 v) {
  return reinterpret_cast<Float4>(reinterpret_cast<Int4>(v) & 0x7fffffff);
}

// Returns a bit per lane that is set.
[[gnu::always_inline]] inline unsigned mask_of(Int4 lanes) {
#ifdef __SSE__
  return static_cast<unsigned>(__builtin_ia32_movmskps(reinterpret_cast<Float4>(lanes)));
#else
  const Int4 bits = lanes & Int4{1, 2, 4, 8};
  return static_cast<unsigned>(bits[0] | bits[1] | bits[2] | bits[3]);
#endif
}

}  // namespace

FloatPose::FloatPose(const Pose& pose) {
  const auto& [x, y, z] = pose.rotation;
  const std::array<double, 9> rows{x.x, x.y, x.z, y.x, y.y, y.z, z.x, z.y, z.z};
  for (std::size_t k = 0; k < 9; ++k) {
    rotation[k] = static_cast<float>(rows[k]);
    size[k] = std::fabs(rotation[k]) + 1e-6f;
  }
  const Vec3f t = narrow(pose.translation);
  translation = {t.x, t.y, t.z};
}

unsigned children_that_meet(const SurfaceTree::Node& node, const SurfaceBounds& other,
                            const FloatPose& pose) {
  const auto& r = pose.rotation;
  const auto& s = pose.size;
  std::array<float, 3> center{}, half{}, normal{};
  for (std::size_t i = 0; i < 3; ++i) {
    center[i] = r[3 * i] * other.center[0] + r[3 * i + 1] * other.center[1] +
                r[3 * i + 2] * other.center[2] + pose.translation[i];
    half[i] =
        s[3 * i] * other.half[0] + s[3 * i + 1] * other.half[1] + s[3 * i + 2] * other.half[2];
    normal[i] = r[3 * i] * other.normal[0] + r[3 * i + 1] * other.normal[1] +
                r[3 * i + 2] * other.normal[2];
  }
  const Float4 d0 = node.center[0] - center[0], d1 = node.center[1] - center[1],
               d2 = node.center[2] - center[2];
  // Boxes along the axes of the node's frame.
  Int4 meets = (magnitude(d0) <= node.half[0] + half[0]) &
               (magnitude(d1) <= node.half[1] + half[1]) &
               (magnitude(d2) <= node.half[2] + half[2]);
  if (mask_of(meets) == 0) return 0;
  // The other's slab, about its box's centre.
  const float other_offset =
      other.offset - (other.normal[0] * other.center[0] + other.normal[1] * other.center[1] +
                      other.normal[2] * other.center[2]);
  meets &= magnitude(normal[0] * d0 + normal[1] * d1 + normal[2] * d2 - other_offset) <=
           other.width + std::fabs(normal[0]) * node.half[0] + std::fabs(normal[1]) * node.half[1] +
               std::fabs(normal[2]) * node.half[2];
  // The slabs of the children.
  Float4 reach = node.width;
  for (std::size_t j = 0; j < 3; ++j)
    reach +=
        magnitude(node.normal[0] * r[j] + node.normal[1] * r[3 + j] + node.normal[2] * r[6 + j]) *
        other.half[j];
  meets &= magnitude(node.normal[0] * center[0] + node.normal[1] * center[1] +
                     node.normal[2] * center[2] - node.offset) <= reach;
  // Boxes along the axes of the other's frame.
  for (std::size_t j = 0; j < 3; ++j)
    meets &=
        magnitude(r[j] * d0 + r[3 + j] * d1 + r[6 + j] * d2) <=
        other.half[j] + s[j] * node.half[0] + s[3 + j] * node.half[1] + s[6 + j] * node.half[2];
  return mask_of(meets);
}

}  // namespace vpm
