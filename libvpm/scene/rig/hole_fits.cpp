#include "libvpm/scene/rig/hole_fits.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "libvpm/cloud/depth_image.h"

namespace vpm {
namespace {

constexpr int kWidest = 48;                   // pixels of a hole, each way
constexpr int kRim = 4;                       // pixels about a hole by which it is fitted
constexpr std::size_t kFew = 12;              // pixels of a surface in a rim: fewer tell nothing
constexpr std::size_t kFewForCurvature = 40;  // of these, fewer tell of a plane only
constexpr double kNearerBy = 3;               // by which a fit is nearer than the rim shows
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
  bool is_small() const { return most.u - least.u < kWidest && most.v - least.v < kWidest; }
};

constexpr Pixel kBeside[] = {{-1, 0}, {1, 0}, {0, -1}, {0, 1}};

// Finds the holes of an image one by one.
class HoleSearch {
 public:
  explicit HoleSearch(const DepthSampler& image)
      : image_(image),
        marks_(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height), 0) {}

  // True for the first pixel of a hole that was not taken.
  bool is_new(int u, int v) const { return is_hole_pixel({u, v}) && marks_[index({u, v})] == 0; }
  // Takes the hole of a pixel, with its rim.
  Hole take(Pixel first) {
    ++number_;
    Hole hole{{first}, {}, first, first};
    marks_[index(first)] = number_;
    for (std::size_t k = 0; k < hole.pixels.size(); ++k) add_beside(hole.pixels[k], hole);
    if (hole.is_small() && hole.is_closed) add_rim(hole);
    return hole;
  }

 private:
  std::size_t index(Pixel at) const { return static_cast<std::size_t>(at.v * image_.width + at.u); }
  bool is_inside(Pixel at) const {
    return at.u >= 0 && at.v >= 0 && at.u < image_.width && at.v < image_.height;
  }
  bool is_known(Pixel at) const { return image_.tiles[0][index(at)].high > 0; }
  bool is_hole_pixel(Pixel at) const {
    return !is_known(at) && !is_removed(image_.measured[index(at)]);
  }

  void add_beside(Pixel own, Hole& hole) {
    for (const Pixel& step : kBeside) {
      const Pixel at{own.u + step.u, own.v + step.v};
      if (!is_inside(at) || (!is_known(at) && !is_hole_pixel(at))) {
        hole.is_closed = false;
      } else if (is_new(at.u, at.v)) {
        marks_[index(at)] = number_;
        hole.least = {std::min(hole.least.u, at.u), std::min(hole.least.v, at.v)};
        hole.most = {std::max(hole.most.u, at.u), std::max(hole.most.v, at.v)};
        hole.pixels.push_back(at);
      }
    }
  }
  void add_rim(Hole& hole) {
    for (const Pixel& own : hole.pixels) {
      const bool is_at_rim = std::ranges::any_of(kBeside, [&](const Pixel& step) {
        return is_known({own.u + step.u, own.v + step.v});
      });
      for (int v = own.v - kRim; is_at_rim && v <= own.v + kRim; ++v) {
        for (int u = own.u - kRim; u <= own.u + kRim; ++u) {
          if (!is_inside({u, v}) || !is_known({u, v}) || marks_[index({u, v})] == number_) continue;
          marks_[index({u, v})] = number_;
          hole.rim.push_back({u, v});
        }
      }
    }
  }

  const DepthSampler& image_;
  std::vector<std::uint32_t> marks_;  // the number of a pixel's hole, or of the last rim it is in
  std::uint32_t number_ = 0;
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

// Fits the surface of some pixels of a rim; nothing where it is not smooth. The fit is nearer than
// these by some deviations, since the surface in the hole may differ from it by more.
class SurfaceFit {
 public:
  SurfaceFit(const DepthSampler& image, const Hole& hole)
      : image_(image), u_(hole.middle_u()), v_(hole.middle_v()) {}

  std::optional<HoleFit> of(const std::vector<Pixel>& pixels) const {
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
    const auto found = solution(matrix, pull, pixels.size() < kFewForCurvature ? 3 : 6);
    if (!found) return std::nullopt;
    double squares = 0;
    for (const Pixel& pixel : pixels) {
      const Numbers terms = terms_at(pixel);
      double off = -inverse_depth(pixel);
      for (std::size_t i = 0; i < terms.size(); ++i) off += terms[i] * (*found)[i];
      if (!(std::fabs(off) <= DepthSampler::kJump * inverse_depth(pixel))) return std::nullopt;
      squares += off * off;
    }
    const double nearer = kNearerBy * std::sqrt(squares / static_cast<double>(pixels.size()));
    const auto number = [&](std::size_t k) { return static_cast<float>((*found)[k]); };
    return HoleFit{static_cast<float>(u_),
                   static_cast<float>(v_),
                   static_cast<float>((*found)[0] + nearer),
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

// The surfaces in the rim of a hole: pixels that steps of less than kJump connect.
class RimSurfaces {
 public:
  RimSurfaces(const DepthSampler& image, const Hole& hole) : hole_(hole) {
    labels_.assign(std::size_t{kSide} * kSide, kBeyond);
    for (const Pixel& pixel : hole.pixels) label(pixel) = kHole;
    for (const Pixel& pixel : hole.rim) label(pixel) = kUnlabelled;
    for (const Pixel& pixel : hole.rim)
      if (label(pixel) == kUnlabelled) spread(image, pixel);
  }

  const std::vector<std::vector<Pixel>>& pixels() const { return surfaces_; }

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
  static constexpr int kSide = kWidest + 2 * kRim + 2;  // one more pixel all around
  static constexpr int kBeyond = -1, kHole = -2, kUnlabelled = -3;
  static constexpr double kShortest = 3;  // pixels
  static constexpr int kAround = 9;       // pixels about one, and itself

  static Pixel around(Pixel at, int k) { return {at.u + k % 3 - 1, at.v + k / 3 - 1}; }
  std::size_t place(Pixel at) const {
    return static_cast<std::size_t>((at.v - hole_.least.v + kRim + 1) * kSide + at.u -
                                    hole_.least.u + kRim + 1);
  }
  int& label(Pixel at) { return labels_[place(at)]; }
  int label_of(Pixel at) const { return labels_[place(at)]; }

  void spread(const DepthSampler& image, Pixel first) {
    const int number = static_cast<int>(surfaces_.size());
    std::vector<Pixel>& pixels = surfaces_.emplace_back(1, first);
    label(first) = number;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      const double own = image.inverse_depth(pixels[i].u, pixels[i].v);
      for (int k = 0; k < kAround; ++k) {
        const Pixel at = around(pixels[i], k);
        if (label(at) != kUnlabelled) continue;
        const double other = image.inverse_depth(at.u, at.v);
        if (std::fabs(other - own) > DepthSampler::kJump * std::max(own, other)) continue;
        label(at) = number;
        pixels.push_back(at);
      }
    }
  }
  bool has_around(Pixel at, int label) const {
    for (int k = 0; k < kAround; ++k)
      if (label_of(around(at, k)) == label) return true;
    return false;
  }
  std::vector<std::pair<double, double>> meetings_of(std::size_t near, int far) const {
    std::vector<std::pair<double, double>> meetings;
    for (const Pixel& pixel : surfaces_[near]) {
      if (!has_around(pixel, kHole)) continue;
      for (int k = 0; k < kAround; ++k) {
        const Pixel at = around(pixel, k);
        if (label_of(at) == far)
          meetings.emplace_back(0.5 * (pixel.u + at.u), 0.5 * (pixel.v + at.v));
      }
    }
    return meetings;
  }
  double mean_aside(const Border& border, std::size_t surface) const {
    double sum = 0;
    for (const Pixel& pixel : surfaces_[surface]) sum += border.aside(pixel.u, pixel.v);
    return sum / static_cast<double>(surfaces_[surface].size());
  }

  const Hole& hole_;
  std::vector<int> labels_;
  std::vector<std::vector<Pixel>> surfaces_;
};

double mean_inverse_depth(const DepthSampler& image, const std::vector<Pixel>& pixels) {
  double sum = 0;
  for (const Pixel& pixel : pixels) sum += image.inverse_depth(pixel.u, pixel.v);
  return sum / static_cast<double>(pixels.size());
}

// Finds the surfaces that go on in a hole, one or two, and calls tell(pixel, fit) for each of its
// pixels: first for all pixels of one fit, then for those of the other.
template <class Tell>
void fit_hole(const DepthSampler& image, const Hole& hole, const Tell& tell) {
  if (!hole.is_small() || !hole.is_closed) return;
  const RimSurfaces rim(image, hole);
  const SurfaceFit fit(image, hole);
  if (rim.pixels().size() == 1) {
    const auto whole = fit.of(rim.pixels().front());
    for (const Pixel& pixel : hole.pixels)
      if (whole) tell(pixel, *whole);
  }
  if (rim.pixels().size() != 2) return;
  const bool is_first_near =
      mean_inverse_depth(image, rim.pixels()[0]) > mean_inverse_depth(image, rim.pixels()[1]);
  const std::size_t near = is_first_near ? 0 : 1, far = 1 - near;
  const auto border = rim.border(near, far);
  const auto near_fit = fit.of(rim.pixels()[near]), far_fit = fit.of(rim.pixels()[far]);
  if (!border || !near_fit || !far_fit) return;
  for (const bool is_far : {false, true}) {
    for (const Pixel& pixel : hole.pixels)
      if ((border->aside(pixel.u, pixel.v) > kAside) == is_far)
        tell(pixel, is_far ? *far_fit : *near_fit);
  }
}

}  // namespace

ImageHoles::ImageHoles(const DepthSampler& image) {
  HoleSearch search(image);
  for (int v = 0; v < image.height; ++v) {
    for (int u = 0; u < image.width; ++u) {
      if (!search.is_new(u, v)) continue;
      const HoleFit* last = nullptr;
      fit_hole(image, search.take({u, v}), [&](Pixel at, const HoleFit& fit) {
        if (last != &fit) fits_.push_back(fit);
        last = &fit;
        numbers_.resize(static_cast<std::size_t>(image.width) *
                        static_cast<std::size_t>(image.height));
        numbers_[static_cast<std::size_t>(at.v * image.width + at.u)] =
            static_cast<std::uint32_t>(fits_.size());
      });
    }
  }
}

}  // namespace vpm
