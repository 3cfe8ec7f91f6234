#include "libvpm/scene/rig/hole_fits.h"

#include <algorithm>
#include <array>
#include <climits>
#include <cmath>
#include <cstring>
#include <iterator>
#include <optional>
#include <utility>

#include "libvpm/cloud/depth_image.h"
#include "libvpm/core/lanes.h"
#include "libvpm/core/parallel.h"

namespace vpm {
namespace {

constexpr int kDeepest = 24;                  // pixels from a hole's rim to its inside
constexpr int kWidest = 2 * kDeepest;         // pixels of a part that is fitted, each way
constexpr int kRim = 4;                       // pixels about a hole by which it is fitted
constexpr std::size_t kFew = 12;              // pixels of a surface in a rim: fewer tell nothing
constexpr std::size_t kFewForCurvature = 40;  // of these, fewer tell of a plane only
constexpr double kNearerBy = 2;               // deviations by which it may be nearer than its fit
constexpr double kAside = 1;  // pixels beyond a border that still are of what is near

struct Pixel {
  int u = 0, v = 0;
};

// A hole, and the pixels around it that have measured something.
struct Hole {
  std::vector<Pixel> pixels, rim;
  Pixel least, most;      // of its pixels
  bool is_closed = true;  // measured pixels are all around it
  double middle_u() const { return 0.5 * (least.u + most.u); }
  double middle_v() const { return 0.5 * (least.v + most.v); }
  int wide() const { return most.u - least.u + 1; }
  int high() const { return most.v - least.v + 1; }
  void add(Pixel at) {
    least = {std::min(least.u, at.u), std::min(least.v, at.v)};
    most = {std::max(most.u, at.u), std::max(most.v, at.v)};
    pixels.push_back(at);
  }
};

constexpr Pixel kBeside[] = {{-1, 0}, {1, 0}, {0, -1}, {0, 1}};
constexpr Pixel kAround[] = {{-1, -1}, {0, -1}, {1, -1}, {-1, 0}, {1, 0}, {-1, 1}, {0, 1}, {1, 1}};
constexpr Pixel operator+(Pixel a, Pixel b) {
  return {a.u + b.u, a.v + b.v};
}

// What a pixel is to the search for holes.
enum Kind : std::uint8_t {
  kKnown,    // something was measured there
  kInRim,    // too, and it is in the rim that is being gathered
  kRemoved,  // nobody knows what is there
  kHole,     // nothing was measured, and no hole was taken yet that it is of
  kTaken,    // of a hole that was taken
  kReached,  // too, and near what was measured
};

// Writes the kinds of an image's pixels.
VPM_VECTOR_CLONES
void find_kinds(const InverseDepthRange* pixels, const float* measured, std::size_t count,
                std::uint8_t* kinds) {
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint8_t unknown = is_removed(measured[i]) ? kRemoved : kHole;
    kinds[i] = pixels[i].high > 0 ? std::uint8_t{kKnown} : unknown;
  }
}

// Finds the holes of an image one by one.
class HoleSearch {
 public:
  explicit HoleSearch(const DepthSampler& image)
      : image_(image),
        kinds_(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height)) {
    find_kinds(image.tiles[0], image.measured, kinds_.size(), kinds_.data());
  }

  // Calls fit(part) for the parts of all holes, with their rims, but for holes of which something
  // is far from all that was measured.
  template <class Fit>
  void run(const Fit& fit) {
    const std::uint8_t *const first = kinds_.data(), *const end = first + kinds_.size(),
                              *at = first;
    const auto next = [&] { return std::memchr(at, kHole, static_cast<std::size_t>(end - at)); };
    while ((at = static_cast<const std::uint8_t*>(next())) != nullptr) {
      const auto index = static_cast<int>(at - first);
      take({index % image_.width, index / image_.width}, fit);
    }
  }

 private:
  std::uint8_t& kind(Pixel at) {
    return kinds_[static_cast<std::size_t>(at.v) * static_cast<std::size_t>(image_.width) +
                  static_cast<std::size_t>(at.u)];
  }
  bool is_inside(Pixel at) const {
    return at.u >= 0 && at.v >= 0 && at.u < image_.width && at.v < image_.height;
  }

  template <class Fit>
  void take(Pixel first, const Fit& fit) {
    Hole hole{{first}, {}, first, first};
    kind(first) = kTaken;
    for (std::size_t k = 0; k < hole.pixels.size(); ++k) add_beside(hole.pixels[k], hole);
    if (hole.is_closed && is_shallow(hole)) fit_parts(std::move(hole), fit);
  }
  void add_beside(Pixel own, Hole& hole) {
    for (const Pixel& step : kBeside) {
      const Pixel at = own + step;
      if (!is_inside(at) || kind(at) == kRemoved) {
        hole.is_closed = false;
      } else if (kind(at) == kHole) {
        kind(at) = kTaken;
        hole.add(at);
      }
    }
  }
  // True for a pixel of a closed hole beside one that has measured something.
  bool is_at_rim(Pixel own) {
    return std::ranges::any_of(kBeside,
                               [&](const Pixel& step) { return kind(own + step) <= kInRim; });
  }
  // True if each pixel of a closed hole is within kDeepest steps of one that has measured
  // something.
  bool is_shallow(const Hole& hole) {
    std::vector<Pixel> reached;
    const auto reach = [&](Pixel at) {
      kind(at) = kReached;
      reached.push_back(at);
    };
    for (const Pixel& own : hole.pixels)
      if (is_at_rim(own)) reach(own);
    std::size_t next = 0;
    for (int step = 1; step < kDeepest; ++step) {
      for (const std::size_t last = reached.size(); next < last; ++next) {
        for (const Pixel& beside : kBeside) {
          const Pixel at = reached[next] + beside;
          if (kind(at) == kTaken) reach(at);
        }
      }
    }
    return reached.size() == hole.pixels.size();
  }
  // Calls fit() of a hole, or of its halves, halved as often as they are too wide.
  template <class Fit>
  void fit_parts(Hole hole, const Fit& fit) {
    if (hole.wide() <= kWidest && hole.high() <= kWidest) {
      add_rim(hole);
      return fit(std::move(hole));
    }
    const bool is_wide = hole.wide() > hole.high();
    const auto is_first = [&](const Pixel& at) {
      return is_wide ? at.u < hole.middle_u() : at.v < hole.middle_v();
    };
    Hole halves[] = {{{}, {}, hole.most, hole.least}, {{}, {}, hole.most, hole.least}};
    for (const Pixel& at : hole.pixels) halves[is_first(at) ? 0 : 1].add(at);
    for (Hole& half : halves) fit_parts(std::move(half), fit);
  }
  void add_rim(Hole& hole) {
    for (const Pixel& own : hole.pixels) {
      if (!is_at_rim(own)) continue;
      const Pixel first{std::max(own.u - kRim, 0), std::max(own.v - kRim, 0)},
          last{std::min(own.u + kRim, image_.width - 1), std::min(own.v + kRim, image_.height - 1)};
      for (int v = first.v; v <= last.v; ++v) {
        for (int u = first.u; u <= last.u; ++u) {
          if (kind({u, v}) != kKnown) continue;
          kind({u, v}) = kInRim;
          hole.rim.push_back({u, v});
        }
      }
    }
    for (const Pixel& pixel : hole.rim) kind(pixel) = kKnown;
  }

  const DepthSampler& image_;
  std::vector<std::uint8_t> kinds_;  // by pixel
};

using Numbers = std::array<double, 6>;  // of a paraboloid

// Solves the first n of symmetric equations by Gauss's eliminations; the numbers after are 0.
std::optional<Numbers> solution(std::array<Numbers, 6> a, Numbers b, std::size_t n) {
  for (std::size_t i = 0; i < n; ++i) {
    const double pivot = a[i][i];
    if (!(pivot > 0)) return std::nullopt;
    for (std::size_t row = 0; row < n; ++row) {
      if (row == i) continue;
      const double times = a[row][i] / pivot;
      for (std::size_t k = i; k < n; ++k) a[row][k] -= times * a[i][k];
      b[row] -= times * b[i];
    }
  }
  Numbers x{};
  for (std::size_t i = 0; i < n; ++i) x[i] = b[i] / a[i][i];
  return x;
}

// Fits the surface of some pixels of a rim; nothing where it is not smooth. In the hole the surface
// may be nearer by some of their deviations from the fit.
class SurfaceFit {
 public:
  SurfaceFit(const DepthSampler& image, const Hole& hole)
      : image_(image), u_(hole.middle_u()), v_(hole.middle_v()) {}

  // Returns the paraboloid, or plane, that is nearest to pixels.
  std::optional<Numbers> nearest_to(const std::vector<Pixel>& pixels) const {
    if (pixels.size() < kFew) return std::nullopt;
    std::array<Numbers, 6> matrix{};
    Numbers pull{};
    for (const Pixel& pixel : pixels) {
      const Numbers terms = terms_at(pixel);
      for (std::size_t i = 0; i < terms.size(); ++i) {
        pull[i] += terms[i] * inverse_depth(pixel);
        for (std::size_t k = 0; k < terms.size(); ++k) matrix[i][k] += terms[i] * terms[k];
      }
    }
    return solution(matrix, pull, pixels.size() < kFewForCurvature ? 3 : 6);
  }
  // Returns by how much a paraboloid is nearer than a pixel.
  double off(const Numbers& paraboloid, Pixel pixel) const {
    const Numbers terms = terms_at(pixel);
    double off = -inverse_depth(pixel);
    for (std::size_t i = 0; i < terms.size(); ++i) off += terms[i] * paraboloid[i];
    return off;
  }

  std::optional<HoleFit> of(const std::vector<Pixel>& pixels) const {
    const auto found = nearest_to(pixels);
    if (!found) return std::nullopt;
    double squares = 0;
    for (const Pixel& pixel : pixels) {
      const double away = off(*found, pixel);
      if (!(std::fabs(away) <= DepthSampler::kJump * inverse_depth(pixel))) return std::nullopt;
      squares += away * away;
    }
    const double nearer = kNearerBy * std::sqrt(squares / static_cast<double>(pixels.size()));
    const auto number = [&](std::size_t k) { return static_cast<float>((*found)[k]); };
    return HoleFit{static_cast<float>(u_),
                   static_cast<float>(v_),
                   static_cast<float>(nearer),
                   number(0),
                   number(1),
                   number(2),
                   number(3),
                   number(4),
                   number(5)};
  }

 private:
  double inverse_depth(Pixel at) const { return image_.inverse_depth(at.u, at.v); }
  Numbers terms_at(Pixel at) const {
    const double x = at.u - u_, y = at.v - v_;
    return {1, x, y, x * x, x * y, y * y};
  }

  const DepthSampler& image_;
  double u_, v_;  // the middle of the hole
};

// A line across a hole, from what is near to what is far beside it.
struct Border {
  double u = 0, v = 0, out_u = 0, out_v = 0;
  double aside(double at_u, double at_v) const { return (at_u - u) * out_u + (at_v - v) * out_v; }
};

// A smooth surface in the rim of a hole.
struct RimSurface {
  std::vector<Pixel> pixels;
  HoleFit fit;
};

// The surfaces in the rim of a hole: pixels that steps of less than kJump connect, or two parts of
// them on either side of a crease.
class RimSurfaces {
 public:
  RimSurfaces(const DepthSampler& image, const Hole& hole)
      : image_(image), hole_(hole), fit_(image, hole) {
    labels_.assign(std::size_t{kSide} * kSide, kBeyond);
    inverse_depths_.resize(labels_.size());
    for (const Pixel& pixel : hole.pixels) label(pixel) = kInHole;
    for (const Pixel& pixel : hole.rim) {
      label(pixel) = kUnlabelled;
      inverse_depths_[place(pixel)] = image.inverse_depth(pixel.u, pixel.v);
    }
    for (const Pixel& pixel : hole.rim)
      if (label(pixel) == kUnlabelled) add(surfaces_of(connected_to(pixel), kSplits, is_told_));
  }

  // True if the rim tells what goes on in the hole: it has surfaces, and all of them are smooth.
  bool are_told() const { return is_told_ && !surfaces_.empty(); }
  const std::vector<RimSurface>& all() const { return surfaces_; }

  // Returns the line through the two places, furthest apart, at which surfaces `near` and `far`
  // meet at the hole.
  std::optional<Border> border(std::size_t near, std::size_t far) const {
    const std::vector<std::pair<double, double>> meetings =
        meetings_of(near, static_cast<int>(far));
    Border border;
    double longest = kShortest;
    for (const auto& [u, v] : meetings) {
      for (const auto& [other_u, other_v] : meetings) {
        const double along_u = other_u - u, along_v = other_v - v,
                     length = std::sqrt(along_u * along_u + along_v * along_v);
        if (!(length > longest)) continue;
        longest = length;
        border = {u, v, -along_v / length, along_u / length};
      }
    }
    if (!(longest > kShortest)) return std::nullopt;
    if (mean_aside(border, far) < mean_aside(border, near))
      border.out_u = -border.out_u, border.out_v = -border.out_v;
    return border;
  }

 private:
  static constexpr int kSplits = 2;                     // of pixels that are not smooth together
  static constexpr int kRounds = 3;                     // in which parts find their surfaces
  static constexpr double kMuchNearer = 0.5;            // part of a deviation
  static constexpr int kSide = kWidest + 2 * kRim + 2;  // one more pixel all around
  static constexpr int kBeyond = -1, kInHole = -2, kUnlabelled = -3;
  static constexpr double kShortest = 3;  // pixels

  std::size_t place(Pixel at) const {
    return static_cast<std::size_t>((at.v - hole_.least.v + kRim + 1) * kSide + at.u -
                                    hole_.least.u + kRim + 1);
  }
  int& label(Pixel at) { return labels_[place(at)]; }
  int label_of(Pixel at) const { return labels_[place(at)]; }
  Vec3 normal(Pixel at) const { return widen(image_.normals[at.v * image_.width + at.u]); }

  std::vector<Pixel> connected_to(Pixel first) {
    std::vector<Pixel> pixels{first};
    label(first) = kBeyond;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      const Pixel pixel = pixels[i];
      const double own = inverse_depths_[place(pixel)];
      for (const Pixel& step : kAround) {
        const Pixel at = pixel + step;
        if (label(at) != kUnlabelled) continue;
        const double other = inverse_depths_[place(at)];
        if (std::fabs(other - own) > DepthSampler::kJump * std::max(own, other)) continue;
        label(at) = kBeyond;
        pixels.push_back(at);
      }
    }
    return pixels;
  }
  void add(std::vector<RimSurface> found) {
    for (RimSurface& surface : found) {
      for (const Pixel& pixel : surface.pixels) label(pixel) = static_cast<int>(surfaces_.size());
      surfaces_.push_back(std::move(surface));
    }
  }
  // Returns the surface of pixels, or those of two parts of them where together they are not
  // smooth, or only roughly: the parts must then be twice as near to their fits. Too few pixels are
  // of none. `is_told` becomes false if a part is not smooth either.
  std::vector<RimSurface> surfaces_of(std::vector<Pixel> pixels, int splits, bool& is_told) const {
    if (pixels.size() < kFew) return {};
    const std::optional<HoleFit> whole = fit_.of(pixels);
    if (splits > 0 && (!whole || is_rough(*whole))) {
      bool are_told = true;
      std::vector<RimSurface> found;
      for (std::vector<Pixel>& part : halves(pixels))
        std::ranges::move(surfaces_of(std::move(part), splits - 1, are_told),
                          std::back_inserter(found));
      double squares = 0;
      for (const RimSurface& surface : found) squares += squares_of(surface.pixels, surface.fit);
      const bool has_parts = !found.empty();  // of a few pixels a part may be too small
      if (!whole || (are_told && has_parts &&
                     squares < kMuchNearer * kMuchNearer * squares_of(pixels, *whole))) {
        is_told = is_told && are_told;
        return found;
      }
    }
    if (whole) return {{std::move(pixels), *whole}};
    is_told = false;
    return {};
  }
  static double squares_of(const std::vector<Pixel>& pixels, const HoleFit& fit) {
    return static_cast<double>(pixels.size()) * fit.nearer * fit.nearer;
  }
  // True if pixels deviate from their fit by more than the width of one, as across a crease.
  bool is_rough(const HoleFit& fit) const { return fit.nearer > kNearerBy * fit.a / image_.k.fx; }
  // Divides pixels by which of two normals, that differ much, theirs is more like; then by which of
  // the surfaces of both parts is nearer, since normals at a crease are between those of its sides.
  std::array<std::vector<Pixel>, 2> halves(const std::vector<Pixel>& pixels) const {
    const auto least_like = [&](const Vec3& other) {
      return normal(*std::ranges::min_element(
          pixels, {}, [&](const Pixel& pixel) { return dot(normal(pixel), other); }));
    };
    const Vec3 one = least_like(normal(pixels.front())), other = least_like(one);
    std::array<std::vector<Pixel>, 2> parts;
    for (const Pixel& pixel : pixels)
      parts[dot(normal(pixel), one - other) < 0 ? 1 : 0].push_back(pixel);
    for (int k = 0; k < kRounds; ++k) {
      const auto first = fit_.nearest_to(parts[0]), second = fit_.nearest_to(parts[1]);
      if (!first || !second) break;
      parts = {};
      for (const Pixel& pixel : pixels) {
        const double off = fit_.off(*first, pixel), other_off = fit_.off(*second, pixel);
        parts[std::fabs(other_off) < std::fabs(off) ? 1 : 0].push_back(pixel);
      }
    }
    return parts;
  }
  bool has_around(Pixel at, int label) const {
    return std::ranges::any_of(kAround,
                               [&](const Pixel& step) { return label_of(at + step) == label; });
  }
  std::vector<std::pair<double, double>> meetings_of(std::size_t near, int far) const {
    std::vector<std::pair<double, double>> meetings;
    for (const Pixel& pixel : surfaces_[near].pixels) {
      if (!has_around(pixel, kInHole)) continue;
      for (const Pixel& step : kAround) {
        const Pixel at = pixel + step;
        if (label_of(at) == far)
          meetings.emplace_back(0.5 * (pixel.u + at.u), 0.5 * (pixel.v + at.v));
      }
    }
    return meetings;
  }
  double mean_aside(const Border& border, std::size_t surface) const {
    double sum = 0;
    for (const Pixel& pixel : surfaces_[surface].pixels) sum += border.aside(pixel.u, pixel.v);
    return sum / static_cast<double>(surfaces_[surface].pixels.size());
  }

  const DepthSampler& image_;
  const Hole& hole_;
  SurfaceFit fit_;
  bool is_told_ = true;
  // Of the hole, its rim and what is about it, row by row; the latter of the rim only.
  std::vector<int> labels_;
  std::vector<double> inverse_depths_;
  std::vector<RimSurface> surfaces_;
};

VPM_AVX2_CLONES
int least_squared_distance(const Pixel* pixels, std::size_t count, Pixel at) {
  int least = INT_MAX;
  for (std::size_t i = 0; i < count; ++i) {
    const int u = pixels[i].u - at.u, v = pixels[i].v - at.v, squared = u * u + v * v;
    least = squared < least ? squared : least;
  }
  return least;
}

// Tells which surface of its rim goes on at a pixel of a hole: that of the nearest pixel. Where
// there are two with a border between them, that tells.
class SurfaceOfPixel {
 public:
  explicit SurfaceOfPixel(const RimSurfaces& rim) : rim_(rim) {
    if (rim.all().size() != 2) return;
    is_first_near_ = rim.all()[0].fit.a > rim.all()[1].fit.a;
    border_ = rim.border(is_first_near_ ? 0 : 1, is_first_near_ ? 1 : 0);
  }

  std::size_t operator()(Pixel at) const {
    if (rim_.all().size() == 1) return 0;
    if (border_) {
      const bool is_far = border_->aside(at.u, at.v) > kAside;
      return is_far == is_first_near_ ? 1 : 0;
    }
    std::size_t nearest = 0;
    int least = INT_MAX;
    for (std::size_t k = 0; k < rim_.all().size(); ++k) {
      const std::vector<Pixel>& pixels = rim_.all()[k].pixels;
      const int own = least_squared_distance(pixels.data(), pixels.size(), at);
      if (own < least) least = own, nearest = k;
    }
    return nearest;
  }

 private:
  const RimSurfaces& rim_;
  bool is_first_near_ = true;
  std::optional<Border> border_;
};

// Calls tell(fit, pixels) for each surface that goes on in a hole.
template <class Tell>
void fit_hole(const DepthSampler& image, const Hole& hole, const Tell& tell) {
  const RimSurfaces rim(image, hole);
  if (!rim.are_told()) return;
  const SurfaceOfPixel surface_of(rim);
  std::vector<std::vector<Pixel>> pixels(rim.all().size());
  for (const Pixel& pixel : hole.pixels) pixels[surface_of(pixel)].push_back(pixel);
  for (std::size_t k = 0; k < pixels.size(); ++k)
    if (!pixels[k].empty()) tell(rim.all()[k].fit, pixels[k]);
}

// Returns an upper bound of the inverse depth, 1/m, that a fit has anywhere in the area of a pixel.
float greatest_at(const HoleFit& fit, Pixel at) {
  constexpr double kHalf = 0.5, kRounding = 1 + 1e-6;
  const FitAt<double> middle =
      evaluate<double>([&](float HoleFit::*number) { return double{fit.*number}; }, at.u, at.v);
  const double more = kHalf * (std::fabs(middle.per_u) + std::fabs(middle.per_v)) +
                      kHalf * kHalf * (std::fabs(fit.d) + std::fabs(fit.e) + std::fabs(fit.f));
  return static_cast<float>(kRounding * (middle.inverse_depth + more));
}

}  // namespace

ImageHoles::ImageHoles(const DepthSampler& image) {
  const auto columns = static_cast<std::size_t>(HoleFits::tiles(image.width));
  const auto tell = [&](const HoleFit& fit, const std::vector<Pixel>& pixels) {
    fits_.push_back(fit);
    greatest_.resize(columns * static_cast<std::size_t>(HoleFits::tiles(image.height)));
    for (const Pixel& at : pixels) {
      const auto pixel = static_cast<std::uint32_t>(at.v * image.width + at.u),
                 number = static_cast<std::uint32_t>(fits_.size());
      numbered_.push_back({pixel, number});
      float& greatest = greatest_[static_cast<std::size_t>(at.v >> HoleFits::kTileShift) * columns +
                                  static_cast<std::size_t>(at.u >> HoleFits::kTileShift)];
      greatest = std::max(greatest, greatest_at(fit, at));
    }
  };
  std::vector<Hole> parts;
  HoleSearch(image).run([&](Hole part) { parts.push_back(std::move(part)); });
  std::vector<std::vector<std::pair<HoleFit, std::vector<Pixel>>>> fitted(parts.size());
  parallel_for(parts.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k)
      fit_hole(image, parts[k], [&](const HoleFit& fit, std::vector<Pixel>& pixels) {
        fitted[k].emplace_back(fit, std::move(pixels));
      });
  });
  for (const auto& fits : fitted)
    for (const auto& [fit, pixels] : fits) tell(fit, pixels);
  columns_ = static_cast<std::int32_t>(columns);
}

void ImageHoles::spread(const DepthSampler& image) {
  if (fits_.empty()) return;
  numbers_.assign(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height),
                  0);
  for (const auto& [pixel, number] : numbered_) numbers_[pixel] = number;
}

}  // namespace vpm
