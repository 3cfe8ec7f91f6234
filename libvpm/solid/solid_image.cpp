#include "libvpm/solid/solid_image.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "libvpm/core/lanes.h"

namespace vpm {
namespace {

constexpr float kNone = std::numeric_limits<float>::infinity();
// What is nearer to the camera's plane than this part of the solid's reach is not drawn.
constexpr double kNearestPart = 0x1p-20;
// Pixels by which float positions in the image are taken for wider than they are.
constexpr float kPad = 0x1p-6F;
// Largest size, pixels, of a triangle whose box is drawn for it.
constexpr int kSmallAcross = 4, kSmallDown = 4;
// Vertices that are projected at once, so that loops vectorise.
constexpr int kBatch = 64;
// Largest distance, pixels, from an image that is told from further ones.
constexpr float kFar = 0x1p24F;

struct FloatPose {
  float xx, xy, xz, x, yx, yy, yz, y, zx, zy, zz, z;
};

FloatPose rounded(const Pose& p) {
  const auto f = [](double value) { return static_cast<float>(value); };
  const Rotation& r = p.rotation;
  return {f(r.row0.x), f(r.row0.y), f(r.row0.z), f(p.translation.x),
          f(r.row1.x), f(r.row1.y), f(r.row1.z), f(p.translation.y),
          f(r.row2.x), f(r.row2.y), f(r.row2.z), f(p.translation.z)};
}

struct Bounds {
  float u0 = kNone, u1 = -kNone, v0 = kNone, v1 = -kNone;  // of vertices before the camera
  float least = kNone, greatest = 0;                       // their inverse depths
  bool has_behind = false;                                 // any that are not
};

[[gnu::always_inline]] inline float limited(float value) {
  const float low = value > -kFar ? value : -kFar;
  return low < kFar ? low : kFar;
}

// Projects vertices [first, first + count) of at most kBatch to out[0], out[4], ...
[[gnu::always_inline]] inline void project_batch(const DrawnSolid& solid, std::size_t first,
                                                 int count, const FloatPose& p, float fx, float fy,
                                                 float cx, float cy, float nearest, float* out,
                                                 Bounds& bounds) {
  float x[kBatch] = {}, y[kBatch] = {}, z[kBatch] = {}, u[kBatch], v[kBatch], w[kBatch];
  std::copy_n(solid.x() + first, count, x);
  std::copy_n(solid.y() + first, count, y);
  std::copy_n(solid.z() + first, count, z);
  for (int i = 0; i < kBatch; ++i) {
    const float depth = p.zx * x[i] + p.zy * y[i] + p.zz * z[i] + p.z;
    const bool is_before = depth > nearest;
    const float inverse = 1 / (is_before ? depth : 1.0F);
    const float across = p.xx * x[i] + p.xy * y[i] + p.xz * z[i] + p.x;
    const float down = p.yx * x[i] + p.yy * y[i] + p.yz * z[i] + p.y;
    u[i] = limited(fx * (across * inverse) + cx);
    v[i] = limited(fy * (down * inverse) + cy);
    w[i] = is_before ? inverse : -1.0F;
  }
  for (int i = 0; i < count; ++i) {
    out[4 * i] = u[i], out[4 * i + 1] = v[i], out[4 * i + 2] = w[i], out[4 * i + 3] = -w[i];
    const bool is_before = w[i] > 0;
    bounds.u0 = is_before && u[i] < bounds.u0 ? u[i] : bounds.u0;
    bounds.u1 = is_before && u[i] > bounds.u1 ? u[i] : bounds.u1;
    bounds.v0 = is_before && v[i] < bounds.v0 ? v[i] : bounds.v0;
    bounds.v1 = is_before && v[i] > bounds.v1 ? v[i] : bounds.v1;
    bounds.least = is_before && w[i] < bounds.least ? w[i] : bounds.least;
    bounds.greatest = is_before && w[i] > bounds.greatest ? w[i] : bounds.greatest;
    bounds.has_behind |= !is_before;
  }
}

VPM_VECTOR_CLONES
Bounds project_all(const DrawnSolid& solid, const FloatPose& p, const Intrinsics& k, float nearest,
                   float* out) {
  Bounds bounds;
  const auto fx = static_cast<float>(k.fx), fy = static_cast<float>(k.fy),
             cx = static_cast<float>(k.cx), cy = static_cast<float>(k.cy);
  for (std::size_t first = 0; first < solid.vertices(); first += kBatch) {
    const auto count = static_cast<int>(std::min<std::size_t>(kBatch, solid.vertices() - first));
    project_batch(solid, first, count, p, fx, fy, cx, cy, nearest, out + 4 * first, bounds);
  }
  return bounds;
}

// Returns the column or row of pixels whose squares hold the position, from `least` to `most`, by
// operations that vectors have.
[[gnu::always_inline]] inline int pixel_of(double position, int least, int most) {
  const double low = least, high = most, at = position + 0.5, above = at > low ? at : low,
               inside = above < high ? above : high;
  const int truncated = static_cast<int>(inside);
  return truncated - (truncated > inside ? 1 : 0);
}

[[gnu::always_inline]] inline Floats lesser(const Floats& a, const Floats& b) {
  return a < b ? a : b;
}
[[gnu::always_inline]] inline HalfFloats lesser(const HalfFloats& a, const HalfFloats& b) {
  return a < b ? a : b;
}
[[gnu::always_inline]] inline HalfFloats greater(const HalfFloats& a, const HalfFloats& b) {
  return a > b ? a : b;
}

// Widens the ranges of four pixels.
[[gnu::always_inline]] inline void widen_four(float* pixels, const Floats& ranges) {
  store(lesser(load<Floats>(pixels), ranges), pixels);
}

struct SmallTriangles {
  const Triangle* triangles;
  std::size_t count;
  const float* vertices;  // four numbers each
  PixelWindow window;
  float* ranges;          // two numbers per pixel, and room for kSmallDown rows and kLanes more
  std::uint32_t* others;  // receives the triangles that are not small
};

// Returns the number of `others`.
VPM_VECTOR_CLONES
std::size_t draw_small(const SmallTriangles& t) {
  const auto width = static_cast<float>(t.window.width()),
             height = static_cast<float>(t.window.height());
  const std::size_t stride = 2 * static_cast<std::size_t>(t.window.width());
  const float u0 = static_cast<float>(t.window.u0) - 0.5F,
              v0 = static_cast<float>(t.window.v0) - 0.5F;
  float only[kSmallAcross][kLanes];         // 0 for as many pixels, then infinite
  float only_rows[kSmallDown][kSmallDown];  // 0 for as many rows, then infinite
  for (int n = 0; n < kSmallDown; ++n)
    for (int i = 0; i < kSmallDown; ++i) only_rows[n][i] = i <= n ? 0 : kNone;
  for (int n = 0; n < kSmallAcross; ++n)
    for (int i = 0; i < kLanes; ++i) only[n][i] = i / 2 <= n ? 0 : kNone;
  std::size_t others = 0;
  for (std::size_t k = 0; k < t.count; ++k) {
    const auto& [a, b, c] = t.triangles[k];
    const auto at = [&](std::uint32_t vertex) __attribute__((always_inline)) {
      return load<HalfFloats>(t.vertices + 4 * std::size_t{vertex});
    };
    const HalfFloats p = at(a), q = at(b), r = at(c);
    const HalfFloats low = lesser(lesser(p, q), r), high = greater(greater(p, q), r);
    if (!(low[2] > 0)) {  // a corner is not before the camera
      if (high[2] > 0) t.others[others++] = static_cast<std::uint32_t>(k);
      continue;
    }
    const float left = low[0] - u0 - kPad, right = high[0] - u0 + kPad, top = low[1] - v0 - kPad,
                bottom = high[1] - v0 + kPad;
    if (!((right >= 0) & (bottom >= 0) & (left < width) & (top < height))) continue;
    if (!((left >= 0) & (top >= 0) & (right < width) & (bottom < height))) {
      t.others[others++] = static_cast<std::uint32_t>(k);
      continue;
    }
    const int first = static_cast<int>(left), last = static_cast<int>(right),
              first_row = static_cast<int>(top), last_row = static_cast<int>(bottom);
    if ((last - first >= kSmallAcross) | (last_row - first_row >= kSmallDown)) {
      t.others[others++] = static_cast<std::uint32_t>(k);
      continue;
    }
    const float far = low[2], near = low[3];
    const Floats ranges =
        Floats{far, near, far, near, far, near, far, near} + load<Floats>(only[last - first]);
    float* pixels = t.ranges + static_cast<std::size_t>(first_row) * stride +
                    2 * static_cast<std::size_t>(first);
    for (int row = 0; row < kSmallDown; ++row, pixels += stride)  // without branches
      widen_four(pixels, ranges + only_rows[last_row - first_row][row]);
  }
  return others;
}

// Sets each of `count` numbers to the lesser of itself and of the one that is as far along
// `further`, which lies behind `numbers`.
[[gnu::always_inline]] inline void take_lesser(float* numbers, const float* further,
                                               std::size_t count) {
  std::size_t i = 0;
  for (; i + kLanes <= count; i += kLanes)
    store(lesser(load<Floats>(numbers + i), load<Floats>(further + i)), numbers + i);
  for (; i < count; ++i) numbers[i] = further[i] < numbers[i] ? further[i] : numbers[i];
}

// Sets each number to the least of `length` numbers that are `step` apart, from itself on; those
// that have fewer behind them become undefined.
[[gnu::always_inline]] inline void take_least(float* numbers, std::size_t count, std::size_t step,
                                              int length) {
  int taken = 1;  // numbers of which each is the least by now
  while (taken < length) {
    const int more = std::min(taken, length - taken);
    const std::size_t apart = static_cast<std::size_t>(more) * step;
    if (apart >= count) return;
    take_lesser(numbers, numbers + apart, count - apart);
    taken += more;
  }
}

VPM_VECTOR_CLONES
void take_least_below(float* numbers, std::size_t width, std::size_t height, int length) {
  take_least(numbers, 2 * width * height, 2 * width, length);
}

VPM_VECTOR_CLONES
void take_least_beside(float* numbers, std::size_t width, std::size_t height, int length) {
  for (std::size_t v = 0; v < height; ++v)
    take_least(numbers + 2 * width * v, 2 * width, 2, length);
}

// Triangles, and pixels of a row, that are drawn at once, so that loops vectorise.
constexpr int kTogether = 8;
using Reals = double[kTogether];

[[gnu::always_inline]] inline double lesser(double a, double b) {
  return b < a ? b : a;
}
[[gnu::always_inline]] inline double greater(double a, double b) {
  return a < b ? b : a;
}

// Sides of triangles in the image, pixels, from the upper end to the lower one.
struct Edges {
  Reals up_u, up_v, down_u, down_v;
  Reals slope;  // columns per row; undefined for edges along a row
};

// Writes where the lines of edges meet the row `v`, also beyond the ends.
[[gnu::always_inline]] inline void meet_row(const Edges& e, const Reals& v, double beside,
                                            Reals& meets) {
  for (int k = 0; k < kTogether; ++k)
    meets[k] = e.up_u[k] + (v[k] + beside - e.up_v[k]) * e.slope[k];
}
[[gnu::always_inline]] inline double within(const Edges& e, int k, double v, double meets) {
  const double above = v >= e.down_v[k] ? e.down_u[k] : meets;
  return v <= e.up_v[k] ? e.up_u[k] : above;
}

// Widens [low, high] by the places of edges in rows about v.
[[gnu::always_inline]] inline void add_edges(const Edges& e, const Reals& v, Reals& low,
                                             Reals& high) {
  constexpr double kHalf = 0.5 + kPad;
  Reals at_top, at_bottom;
  meet_row(e, v, -kHalf, at_top);
  meet_row(e, v, kHalf, at_bottom);
  for (int k = 0; k < kTogether; ++k) {
    const double top = v[k] - kHalf, bottom = v[k] + kHalf;
    const bool is_there = (e.down_v[k] >= top) & (e.up_v[k] <= bottom);
    const double first = within(e, k, top, at_top[k]), last = within(e, k, bottom, at_bottom[k]);
    const double less = is_there ? lesser(first, last) : HUGE_VAL,
                 more = is_there ? greater(first, last) : -HUGE_VAL;
    low[k] = lesser(low[k], less);
    high[k] = greater(high[k], more);
  }
}

// Corners of triangles.
struct Corners {
  Reals x[3] = {}, y[3] = {}, z[3] = {};

  Vec3 at(int corner, int triangle) const {
    return {x[corner][triangle], y[corner][triangle], z[corner][triangle]};
  }
};

// Maps the corners of the first `count` triangles to the camera's coordinates. Returns true if all
// have a depth of more than `nearest`.
VPM_VECTOR_CLONES
bool map_to_camera(const Pose& to_camera, double nearest, int count, Corners& corners) {
  const Pose pose = to_camera;
  int others = 0;  // corners that are not so deep
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < kTogether; ++k) {
      const Vec3 at = pose * corners.at(i, k);
      corners.x[i][k] = at.x, corners.y[i][k] = at.y, corners.z[i][k] = at.z;
      others += (k < count) & !(at.z > nearest);
    }
  return others == 0;
}

// Triangles in the image. Inverse depth is affine in each, and in a pixel's square at most `half`
// from that in the pixel's middle.
struct ProjectedTriangles {
  Edges edges[3];
  Reals inverse, u, v;  // of the first corner
  Reals along_u, along_v, half;
  Reals least, greatest;  // inverse depths of corners
  Reals top, bottom;      // rows
};

[[gnu::always_inline]] inline void project_corners(const Corners& corners, const Intrinsics& camera,
                                                   ProjectedTriangles& t) {
  const double fx = camera.fx, fy = camera.fy, cx = camera.cx, cy = camera.cy;
  for (int k = 0; k < kTogether; ++k) {
    double p[3], q[3], w[3];
    for (int i = 0; i < 3; ++i) {
      w[i] = 1 / corners.z[i][k];
      p[i] = fx * (corners.x[i][k] * w[i]) + cx;
      q[i] = fy * (corners.y[i][k] * w[i]) + cy;
    }
    t.least[k] = lesser(lesser(w[0], w[1]), w[2]);
    t.greatest[k] = greater(greater(w[0], w[1]), w[2]);
    const double area = (p[1] - p[0]) * (q[2] - q[0]) - (p[2] - p[0]) * (q[1] - q[0]);
    const double db = w[1] - w[0], dc = w[2] - w[0];
    const bool is_seen_flat = std::abs(area) > 1e-9;  // else from the side: all of its range
    const double slope_u = (db * (q[2] - q[0]) - dc * (q[1] - q[0])) / area,
                 slope_v = (dc * (p[1] - p[0]) - db * (p[2] - p[0])) / area;
    t.along_u[k] = is_seen_flat ? slope_u : 0;
    t.along_v[k] = is_seen_flat ? slope_v : 0;
    t.half[k] = is_seen_flat ? (0.5 + kPad) * (std::abs(slope_u) + std::abs(slope_v)) : HUGE_VAL;
    t.inverse[k] = w[0], t.u[k] = p[0], t.v[k] = q[0];
    for (int i = 0; i < 3; ++i) {
      const int next = (i + 1) % 3;
      const bool is_down = q[i] <= q[next];
      Edges& e = t.edges[i];
      e.up_u[k] = is_down ? p[i] : p[next];
      e.up_v[k] = is_down ? q[i] : q[next];
      e.down_u[k] = is_down ? p[next] : p[i];
      e.down_v[k] = is_down ? q[next] : q[i];
      e.slope[k] = (e.down_u[k] - e.up_u[k]) / (e.down_v[k] - e.up_v[k]);
    }
    t.top[k] = lesser(lesser(q[0], q[1]), q[2]);
    t.bottom[k] = greater(greater(q[0], q[1]), q[2]);
  }
}

// A plane's inverse depth in a row of pixels: middle(u) - half to middle(u) + half in their
// squares, within that of a triangle's corners.
struct PlaneInRow {
  double inverse, along_u, u, along_row, half, least, greatest;
};

// Widens the ranges of inverse depth that a row holds of its pixels from `first` to `last` by that
// of a triangle's plane over each. Takes kTogether at once, so the row has room for as many after
// `last`.
[[gnu::always_inline]] inline void widen_row(const PlaneInRow& plane, int first, int last,
                                             float* row) {
  for (int u = first; u <= last; u += kTogether) {
    float found[2 * kTogether];
    const int count = last - u + 1;
    for (int i = 0; i < kTogether; ++i) {
      const double middle = plane.inverse + plane.along_u * (u + i - plane.u) + plane.along_row;
      const double low = middle - plane.half, high = middle + plane.half;
      // An undefined middle, infinity times 0, leaves the corners' range.
      const double far = low > plane.least ? lesser(low, plane.greatest) : plane.least;
      const double near = high < plane.greatest ? greater(high, plane.least) : plane.greatest;
      found[2 * i] = i < count ? static_cast<float>(far) : kNone;
      found[2 * i + 1] = i < count ? static_cast<float>(-near) : kNone;
    }
    float* const pixels = row + 2 * static_cast<std::ptrdiff_t>(u);
    for (int i = 0; i < 2 * kTogether && i < 2 * count; i += kLanes)
      widen_four(pixels + i, load<Floats>(found + i));
  }
}

}  // namespace

PixelWindow common(const PixelWindow& a, const PixelWindow& b) {
  return {std::max(a.u0, b.u0), std::max(a.v0, b.v0), std::min(a.u1, b.u1), std::min(a.v1, b.v1)};
}

DrawnSolid::DrawnSolid(const SolidSurface& surface)
    : triangles_(surface.tree().triangles()),
      center_(surface.center_of_mass()),
      reach_(surface.reach()) {
  for (const Vec3& vertex : surface.tree().vertices()) {
    x_.push_back(static_cast<float>(vertex.x));
    y_.push_back(static_cast<float>(vertex.y));
    z_.push_back(static_cast<float>(vertex.z));
  }
}

PixelWindow SolidImage::project(const DrawnSolid& solid, const Pose& to_camera, const Intrinsics& k,
                                const PixelWindow& most) {
  solid_ = &solid;
  to_camera_ = {to_camera.rotation, to_camera * solid.center()};
  k_ = k;
  nearest_depth_ = kNearestPart * solid.reach();
  greatest_inverse_ = least_inverse_ = 0;
  has_behind_ = false;
  vertices_.clear();
  // Beyond these no float places a vertex, and no camera measures.
  constexpr double kFarthest = 0x1p60;
  if (!(norm(to_camera_.translation) + solid.reach() < kFarthest)) return {};
  vertices_.resize(solid.vertices());
  const Bounds bounds = project_all(solid, rounded(to_camera_), k,
                                    static_cast<float>(nearest_depth_), &vertices_.data()->u);
  greatest_inverse_ = bounds.greatest;
  has_behind_ = bounds.has_behind;
  if (!(bounds.greatest > 0)) return {};
  least_inverse_ = bounds.least;
  if (bounds.has_behind) return most;
  const float pad = 2 * kPad;
  return common(most, {pixel_of(bounds.u0 - pad, most.u0, most.u1),
                       pixel_of(bounds.v0 - pad, most.v0, most.v1),
                       pixel_of(bounds.u1 + pad, most.u0 - 1, most.u1 - 1) + 1,
                       pixel_of(bounds.v1 + pad, most.v0 - 1, most.v1 - 1) + 1});
}

// Triangles that wait to be drawn together.
struct SolidImage::Batch {
  Corners corners;
  int count = 0;

  bool is_full() const { return count == kTogether; }
  void add(const Vec3 (&at)[3]) {
    for (int i = 0; i < 3; ++i) {
      corners.x[i][count] = at[i].x;
      corners.y[i][count] = at[i].y;
      corners.z[i][count] = at[i].z;
    }
    ++count;
  }
};

void SolidImage::draw(const PixelWindow& window) {
  window_ = window;
  moved_ = 0;
  const std::size_t pixels =
      static_cast<std::size_t>(window.width()) * static_cast<std::size_t>(window.height());
  const std::size_t below = kSmallDown * static_cast<std::size_t>(window.width());
  ranges_.assign(pixels + below + kLanes, DrawnRange{});
  if (vertices_.empty()) return;
  const std::vector<Triangle>& triangles = solid_->triangles();
  others_.resize(triangles.size());
  const std::size_t others = draw_small({triangles.data(), triangles.size(), &vertices_.data()->u,
                                         window, &ranges_.data()->farthest, others_.data()});
  Batch whole, rest;
  for (std::size_t k = 0; k < others; ++k) {
    const Triangle& triangle = triangles[others_[k]];
    whole.add({vertex(triangle[0]), vertex(triangle[1]), vertex(triangle[2])});
    if (whole.is_full()) draw_mapped(whole, rest);
  }
  draw_mapped(whole, rest);
  draw_batch(rest);
}

[[gnu::always_inline]] inline Vec3 SolidImage::vertex(std::uint32_t number) const {
  return {solid_->x()[number], solid_->y()[number], solid_->z()[number]};
}

// Draws a batch in the solid's coordinates; what is left of those that are not wholly before the
// camera is added to `rest`.
void SolidImage::draw_mapped(Batch& batch, Batch& rest) {
  if (map_to_camera(to_camera_, nearest_depth_, batch.count, batch.corners))
    return draw_batch(batch);
  for (int k = 0; k < batch.count; ++k) {
    const Corners& c = batch.corners;
    draw_clipped({c.at(0, k), c.at(1, k), c.at(2, k)}, rest);
  }
  batch.count = 0;
}

// Cuts off what is not before the camera, and draws the rest.
void SolidImage::draw_clipped(const Vec3 (&whole)[3], Batch& batch) {
  Vec3 corners[4];
  int count = 0;
  for (int i = 0; i < 3; ++i) {
    const Vec3 &a = whole[i], &b = whole[(i + 1) % 3];
    const bool is_a_before = a.z > nearest_depth_, is_b_before = b.z > nearest_depth_;
    if (is_a_before) corners[count++] = a;
    if (is_a_before == is_b_before) continue;
    // From the same end for both triangles of an edge.
    const Vec3 &before = is_a_before ? a : b, &behind = is_a_before ? b : a;
    const double part = (nearest_depth_ - before.z) / (behind.z - before.z);
    corners[count] = before + part * (behind - before);
    corners[count++].z = nearest_depth_;
  }
  for (int i = 2; i < count; ++i) {
    batch.add({corners[0], corners[i - 1], corners[i]});
    if (batch.is_full()) draw_batch(batch);
  }
}

// Draws triangles row by row: each pixel whose square one meets gets the range of inverse depth
// that its plane has in the square, within that of the corners.
VPM_VECTOR_CLONES
void SolidImage::draw_batch(Batch& batch) {
  const PixelWindow window = window_;
  ProjectedTriangles t;
  project_corners(batch.corners, k_, t);
  int first_row[kTogether], last_row[kTogether], rows = 0;
  for (int k = 0; k < kTogether; ++k) {
    first_row[k] = pixel_of(t.top[k] - kPad, window.v0, window.v1);
    last_row[k] = pixel_of(t.bottom[k] + kPad, window.v0 - 1, window.v1 - 1);
  }
  for (int k = 0; k < batch.count; ++k) rows = std::max(rows, last_row[k] - first_row[k] + 1);
  for (int row = 0; row < rows; ++row) {
    int first[kTogether], last[kTogether];
    Reals at, along_row, low, high;
    for (int k = 0; k < kTogether; ++k) {
      at[k] = first_row[k] + row;
      along_row[k] = t.along_v[k] * (at[k] - t.v[k]);
      low[k] = HUGE_VAL, high[k] = -HUGE_VAL;
    }
    for (const Edges& edges : t.edges) add_edges(edges, at, low, high);
    for (int k = 0; k < kTogether; ++k) {
      first[k] = pixel_of(low[k] - kPad, window.u0, window.u1);
      last[k] = pixel_of(high[k] + kPad, window.u0 - 1, window.u1 - 1);
    }
    for (int k = 0; k < batch.count; ++k) {
      const int v = first_row[k] + row;
      if (v > last_row[k] || !(low[k] <= high[k])) continue;
      widen_row(
          {t.inverse[k], t.along_u[k], t.u[k], along_row[k], t.half[k], t.least[k], t.greatest[k]},
          first[k], last[k],
          &ranges_[first_of(v)].farthest - 2 * static_cast<std::ptrdiff_t>(window.u0));
    }
  }
  batch.count = 0;
}

void SolidImage::widen(int across, int down) {
  float* const numbers = &ranges_.data()->farthest;
  const auto width = static_cast<std::size_t>(window_.width()),
             height = static_cast<std::size_t>(window_.height());
  take_least_below(numbers, width, height, 2 * down + 1);
  take_least_beside(numbers, width, height - 2 * static_cast<std::size_t>(down), 2 * across + 1);
  // Both passes left in each pixel the range of a rectangle that begins there. The range belongs to
  // the rectangle's middle, from which `moved_` leads back to its first pixel.
  moved_ = static_cast<std::size_t>(down) * width + static_cast<std::size_t>(across);
}

bool SolidImage::keep(float low, float high) {
  bool any = false;
  for (DrawnRange& range : ranges_) {
    const bool is_kept = -range.nearest > low && -range.nearest <= high;
    any |= is_kept;
    range.farthest = is_kept ? range.farthest : kNone;
    range.nearest = is_kept ? range.nearest : kNone;
  }
  return any;
}

bool SolidImage::is_near(double depth, double margin, const PixelWindow& image) const {
  if (vertices_.empty() || (!has_behind_ && greatest_inverse_ * depth < 1)) return false;
  // A place that is seen has a slope between those of the image's sides, and a depth of at most
  // `margin` more than the vertex that it belongs to.
  const double left = std::min(0.0, (image.u0 - 0.5 - k_.cx) / k_.fx),
               right = std::max(0.0, (image.u1 - 0.5 - k_.cx) / k_.fx),
               top = std::min(0.0, (image.v0 - 0.5 - k_.cy) / k_.fy),
               bottom = std::max(0.0, (image.v1 - 0.5 - k_.cy) / k_.fy);
  std::vector<std::uint8_t> beyond;  // sides of what is near that a vertex lies beyond
  for (std::uint32_t k = 0; k < vertices_.size(); ++k) {
    const Vec3 x = to_camera_ * vertex(k);
    const double z = x.z + margin;
    beyond.push_back(static_cast<std::uint8_t>(
        (z < 0 ? 1 : 0) | (x.z > depth ? 2 : 0) | (x.x + margin < left * z ? 4 : 0) |
        (x.x - margin > right * z ? 8 : 0) | (x.y + margin < top * z ? 16 : 0) |
        (x.y - margin > bottom * z ? 32 : 0)));
  }
  return std::ranges::any_of(solid_->triangles(), [&](const Triangle& t) {
    return (beyond[t[0]] & beyond[t[1]] & beyond[t[2]]) == 0;
  });
}

}  // namespace vpm
