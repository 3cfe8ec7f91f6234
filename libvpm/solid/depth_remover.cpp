#include "libvpm/solid/depth_remover.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "libvpm/cloud/depth_image.h"
#include "libvpm/core/error.h"
#include "libvpm/core/exact_pose.h"
#include "libvpm/core/lanes.h"

namespace vpm {
namespace {

constexpr float kNever = std::numeric_limits<float>::infinity();
// Factors by which noise alone changes a depth.
constexpr float kLess = 1 - static_cast<float>(kEdgeGate),
                kMore = 1 + static_cast<float>(kEdgeGate);
// A margin in metres takes more pixels the nearer a place is. A solid whose greatest inverse depth
// is at most this many times its least is widened as a whole, by the pixels that its nearest place
// needs; others are widened in several ranges of depth.
constexpr float kOneStep = 2.5F;

// Depth, m, up to which no depth camera measures well, and the part of the image, 1 in so many,
// that the nearest places may then be off by: widening by more takes longer.
constexpr double kUnmeasured = 0.1, kLargePart = 8;

struct RowCounts {
  std::uint32_t in_view = 0, hidden = 0, explained = 0;
};
void count(const RowCounts& row, RemovedSolid& found) {
  found.in_view += row.in_view;
  found.hidden += row.hidden;
  found.explained += row.explained;
}

// Returns the depth from which on a surface at most `margin` nearer than `range` explains.
[[gnu::always_inline]] inline float limit_of(const DrawnRange& range, float margin) {
  const float limit = (-1 / range.nearest - margin) * kLess;
  return limit > 0 ? limit : 0.0F;
}
[[gnu::always_inline]] inline bool is_up_to(float depth, const DrawnRange& range, float margin) {
  return range.farthest * (depth / kMore - margin) <= 1;
}

VPM_VECTOR_CLONES
RowCounts take_silhouette_row(const DrawnRange* ranges, int count, float margin, const float* depth,
                              float* limits) {
  RowCounts counts;
  for (int u = 0; u < count; ++u) {
    const float limit = limit_of(ranges[u], margin), d = depth[u];
    const bool is_there = ranges[u].nearest < 0, has_depth = is_measured(d);
    const bool is_hidden = is_there & has_depth & (d < limit), is_taken = is_there & !is_hidden;
    limits[u] = is_taken & (limit < limits[u]) ? limit : limits[u];
    counts.in_view += is_there;
    counts.hidden += is_hidden;
    counts.explained += is_taken & has_depth & is_up_to(d, ranges[u], margin);
  }
  return counts;
}

VPM_VECTOR_CLONES
void take_range_row(const DrawnRange* ranges, int count, float margin, float* depth,
                    float* limits) {
  for (int u = 0; u < count; ++u) {
    const float limit = limit_of(ranges[u], margin), d = depth[u];
    const bool is_there = ranges[u].nearest < 0, has_depth = is_measured(d);
    const bool is_taken = is_there & has_depth & (d >= limit) & is_up_to(d, ranges[u], margin);
    limits[u] = is_taken & (limit < limits[u]) ? limit : limits[u];
    depth[u] = is_there & !has_depth ? kRemovedDepth : d;
  }
}

// Writes the least of three limits above each other, and of three beside each other to `least`.
VPM_VECTOR_CLONES
void least_of_nine(const float* above, const float* own, const float* below, int count,
                   float* column, float* least) {
  for (int u = 0; u < count; ++u) {
    const float outer = above[u] < below[u] ? above[u] : below[u];
    column[u + 1] = own[u] < outer ? own[u] : outer;
  }
  for (int u = 0; u < count; ++u) {
    const float outer = column[u] < column[u + 2] ? column[u] : column[u + 2];
    least[u] = column[u + 1] < outer ? column[u + 1] : outer;
  }
}

VPM_VECTOR_CLONES
std::uint32_t mark_row(const float* least, int count, float* depth) {
  std::uint32_t removed = 0;
  for (int u = 0; u < count; ++u) {
    const float d = depth[u], limit = least[u];
    const bool has_depth = is_measured(d),
               is_taken = (limit < kNever) & (!has_depth | (d >= limit));
    removed += has_depth & is_taken;
    depth[u] = is_taken ? kRemovedDepth : d;
  }
  return removed;
}

// Tells for each pixel of a row if it was measured and one of its neighbours is removed.
VPM_VECTOR_CLONES
void find_removed(const float* above, const float* own, const float* below, int count,
                  std::uint32_t* column, std::uint32_t* is_beside) {
  for (int u = 0; u < count; ++u)
    column[u + 1] = is_removed(above[u]) | is_removed(own[u]) | is_removed(below[u]);
  for (int u = 0; u < count; ++u)
    is_beside[u] = (column[u] | column[u + 1] | column[u + 2]) & is_measured(own[u]);
}

// Returns the window about both; an empty one changes nothing.
PixelWindow united(const PixelWindow& a, const PixelWindow& b) {
  if (a.is_empty()) return b;
  if (b.is_empty()) return a;
  return {std::min(a.u0, b.u0), std::min(a.v0, b.v0), std::max(a.u1, b.u1), std::max(a.v1, b.v1)};
}

Pose pose_of(const SolidPlace& place, std::size_t k) {
  const std::string where = "solid " + std::to_string(k);
  if (!(place.margin >= 0 && std::isfinite(place.margin)))
    throw Error(ErrorKind::invalid_argument, "the margin must be finite and not negative", where);
  try {
    return exact_pose(place.to_world);
  } catch (const Error& fault) {
    throw Error(fault.kind(), fault.problem(), where + ", " + fault.where(), fault.hint());
  }
}

// How far a place that the camera sees may be in the image from where its pose puts it, pixels
// times metres of depth, for a place at most a metre away. With the place x at depth z, its true
// place x', seen at the slope t = x'/z', is off by |(x - x') - t (z - z')| / z.
struct Spread {
  double across, down;

  explicit Spread(const Camera& camera) {
    const Intrinsics& k = camera.intrinsics;
    const auto of = [](double f, double c, double size) {
      const double slope = std::max(std::abs(-0.5 - c), std::abs(size - 0.5 - c)) / f;
      return f * std::sqrt(1 + slope * slope);
    };
    across = of(k.fx, k.cx, camera.width);
    down = of(k.fy, k.cy, camera.height);
  }
};

}  // namespace

DepthRemover::DepthRemover(std::span<const std::shared_ptr<const SolidSurface>> solids)
    : surfaces_(solids.begin(), solids.end()), found_(solids.size()) {
  for (const auto& surface : solids) solids_.emplace_back(*surface);
}

std::size_t DepthRemover::remove(std::span<const SolidPlace> places, const Camera& camera,
                                 std::span<float> depth) {
  validate(camera, "the depth image");
  if (places.size() != solids_.size())
    throw Error(ErrorKind::invalid_argument,
                std::to_string(places.size()) + " places, but " + std::to_string(solids_.size()) +
                    " solids",
                "the solids to remove");
  if (depth.size() != std::size_t{camera.width} * camera.height)
    refuse("it has " + std::to_string(depth.size()) + " values for a size of " +
               std::to_string(camera.width) + " x " + std::to_string(camera.height),
           "the depth image");
  whole_ = {0, 0, static_cast<int>(camera.width), static_cast<int>(camera.height)};
  changed_ = {};
  limits_.assign(depth.size(), kNever);
  for (std::size_t k = 0; k < places.size(); ++k) {
    const Pose to_world = pose_of(places[k], k);
    remove_solid(k, relative_to(camera.to_world, to_world), places[k].margin, camera, depth);
  }
  return mark(depth);
}

void DepthRemover::remove_solid(std::size_t k, const Pose& to_camera, double margin,
                                const Camera& camera, std::span<float> depth) {
  RemovedSolid& found = found_[k] = {};
  const Vec3 eye = inverse(to_camera).translation - solids_[k].center();
  found.holds_camera = norm(eye) <= solids_[k].reach() && surfaces_[k]->holds(eye);
  const PixelWindow box = image_.project(solids_[k], to_camera, camera.intrinsics,
                                         whole_.grown(whole_.width(), whole_.height()));
  const Spread spread(camera);
  // Nearer places may be anywhere in the image, or in a large part of it where no camera measures.
  const double anywhere =
      margin * std::max(spread.across / camera.width, spread.down / camera.height);
  const double near = std::max(anywhere, std::min(kLargePart * anywhere, kUnmeasured));
  if (margin > 0 && image_.is_near(near, margin, whole_)) take_nearer(near + margin, depth);
  if (box.is_empty()) return;
  const auto pixels_at = [&](double of_metre, double inverse) {
    return margin > 0 ? static_cast<int>(of_metre * margin * inverse) + 1 : 0;
  };
  float high = image_.greatest_inverse();
  if (margin > 0) high = std::min(high, static_cast<float>(1 / near));
  int across = pixels_at(spread.across, high), down = pixels_at(spread.down, high);
  const PixelWindow seen = common(box.grown(across, down), whole_);
  if (seen.is_empty()) return;
  changed_ = united(changed_, seen);
  image_.draw(seen.grown(across, down));
  take_rows(seen, margin, depth, [&](auto... row) { count(take_silhouette_row(row...), found); });
  if (margin == 0) return;
  // Places further away need fewer pixels: each step takes those that need more than half as many.
  const bool is_one = high <= kOneStep * image_.least_inverse();
  if (is_one && high == image_.greatest_inverse()) {
    image_.widen(across, down);
    return take_rows(seen, margin, depth, take_range_row);
  }
  const SolidImage drawn = image_;
  for (float above = high; above >= image_.least_inverse(); above /= 2) {
    image_ = drawn;
    // What is nearer than the nearest step hides places in the same pixels that are not.
    if (!image_.keep(above / 2, above == high ? kNever : above)) continue;
    image_.widen(pixels_at(spread.across, above), pixels_at(spread.down, above));
    take_rows(seen, margin, depth, take_range_row);
  }
}

template <class TakeRow>
void DepthRemover::take_rows(const PixelWindow& seen, double margin, std::span<float> depth,
                             const TakeRow& take_row) {
  for (int v = seen.v0; v < seen.v1; ++v) {
    const std::size_t at = static_cast<std::size_t>(v) * static_cast<std::size_t>(whole_.u1) +
                           static_cast<std::size_t>(seen.u0);
    take_row(image_.row(v) + (seen.u0 - image_.window().u0), seen.width(),
             static_cast<float>(margin), depth.data() + at, limits_.data() + at);
  }
}

// Takes all pixels that were measured no further than `farthest`, m.
void DepthRemover::take_nearer(double farthest, std::span<const float> depth) {
  const float most = static_cast<float>(farthest) * kMore;
  for (std::size_t k = 0; k < depth.size(); ++k)
    if (is_measured(depth[k]) && depth[k] <= most) limits_[k] = 0;
  changed_ = whole_;
}

// Removes what is explained, and what is beside it and not before it.
std::size_t DepthRemover::mark(std::span<float> depth) {
  if (changed_.is_empty()) return 0;
  const PixelWindow window = common(changed_.grown(1, 1), whole_);
  const auto width = static_cast<std::size_t>(whole_.u1);
  const std::vector<float> never(width, kNever);
  std::vector<float> column(static_cast<std::size_t>(window.width()) + 2, kNever),
      least(static_cast<std::size_t>(window.width()));
  const auto row = [&](int v) {
    const bool is_in_image = v >= 0 && v < whole_.v1;
    return (is_in_image ? limits_.data() + static_cast<std::size_t>(v) * width : never.data()) +
           window.u0;
  };
  std::size_t removed = 0;
  for (int v = window.v0; v < window.v1; ++v) {
    least_of_nine(row(v - 1), row(v), row(v + 1), window.width(), column.data(), least.data());
    removed += mark_row(least.data(), window.width(),
                        depth.data() + static_cast<std::size_t>(v) * width + window.u0);
  }
  const std::vector<std::size_t> alone = beside_removed_alone(depth);
  for (const std::size_t pixel : alone) depth[pixel] = kRemovedDepth;
  return removed + alone.size();
}

// True if fewer than two of a pixel's neighbours show the surface that it shows.
bool DepthRemover::is_alone(int u, int v, std::span<const float> depth) const {
  const auto at = [&](int x, int y) {
    return depth[static_cast<std::size_t>(y) * static_cast<std::size_t>(whole_.u1) +
                 static_cast<std::size_t>(x)];
  };
  const float own = at(u, v), most = static_cast<float>(kEdgeGate) * own;
  int alike = -1;  // without itself
  for (int y = std::max(v - 1, 0); y <= std::min(v + 1, whole_.v1 - 1); ++y)
    for (int x = std::max(u - 1, 0); x <= std::min(u + 1, whole_.u1 - 1); ++x)
      alike += std::abs(at(x, y) - own) <= most;
  return alike < 2;
}

// Returns the pixels beside removed ones that no neighbours support: mixed ones at the tips of
// solids, which have no neighbour that the solid explains.
std::vector<std::size_t> DepthRemover::beside_removed_alone(std::span<const float> depth) const {
  const PixelWindow window = common(changed_.grown(2, 2), whole_);
  const auto width = static_cast<std::size_t>(whole_.u1);
  const std::vector<float> none(width, 0.0F);
  std::vector<std::uint32_t> column(static_cast<std::size_t>(window.width()) + 2),
      is_beside(static_cast<std::size_t>(window.width()));
  const auto row = [&](int v) {
    const bool is_in_image = v >= 0 && v < whole_.v1;
    return (is_in_image ? depth.data() + static_cast<std::size_t>(v) * width : none.data()) +
           window.u0;
  };
  std::vector<std::size_t> alone;
  for (int v = window.v0; v < window.v1; ++v) {
    find_removed(row(v - 1), row(v), row(v + 1), window.width(), column.data(), is_beside.data());
    for (int u = window.u0; u < window.u1; ++u)
      if (is_beside[static_cast<std::size_t>(u - window.u0)] != 0 && is_alone(u, v, depth))
        alone.push_back(static_cast<std::size_t>(v) * width + static_cast<std::size_t>(u));
  }
  return alone;
}

}  // namespace vpm
