#include "libvpm/packing/packer.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "libvpm/core/error.h"
#include "libvpm/model/sphere.h"
#include "libvpm/packing/fill_band.h"
#include "libvpm/packing/fill_quality.h"
#include "libvpm/packing/solid_distance.h"
#include "libvpm/packing/space.h"

namespace vpm {
namespace {

// Width of a band, whose spheres are found together. First spheres decide the coverage of small
// packings, so their bands are narrow and each is placed into contact; later ones only need roughly
// the right order.
constexpr double kFirstBand = 0.998, kLaterBand = 0.99;
// Width of a band from kNearlyFull on. Where spheres of one size fit at tens of thousands of
// places, bounds that are a few per cent too large hide which places hold one: narrower bands would
// search nearly all of them in vain.
constexpr double kRoughBand = 0.95;
// A part of the room that was not searched is worth telling if it may hold spheres larger than the
// smallest delivered by this factor.
constexpr double kMuchLarger = 1.01;
// Bands are completed, so that fewer spheres are a prefix of more, unless a band brings more than
// this beyond twice the number: a plate holds millions of equal spheres.
constexpr std::size_t kFinishedBand = 1000;
constexpr std::size_t kMaxSpheres = std::size_t{1} << 30;  // keeps indices within 32 bits
// Number of blocks of Space. Solids of all proportions have about ten blocks per sphere; a plate of
// 1:100000 would have 10^9 blocks.
constexpr std::size_t kBlocks = std::size_t{1} << 16, kBlocksPerSphere = 32;
// The uncovered volume falls with the number of spheres to the power of -1 / this.
constexpr double kApollonianPower = 4.7;

void check(const PackOptions& options) {
  const auto wrong = [](const std::string& what) {
    throw Error(ErrorKind::invalid_argument, what);
  };
  if (!(options.coverage > 0 && options.coverage <= 1))
    wrong("the coverage to reach must be above 0 and at most 1");
  if (!(options.inertia_error >= 0)) wrong("the inertia error must be 0 or a positive number");
  if (!(options.min_radius >= 0) || !std::isfinite(options.min_radius))
    wrong("the smallest radius must be 0 or a positive number");
  if (!(options.max_radius > 0)) wrong("the largest radius must be a positive number");
  if (options.max_radius < options.min_radius)
    wrong("the largest radius must not be below the smallest");
}

class Packer {
 public:
  Packer(const Solid& solid, const PackOptions& options)
      : options_(options),
        distance_(solid, options.enclosure),
        frame_(distance_.frame()),
        volume_(distance_.volume()),
        smallest_(std::max(options.min_radius / frame_.scale, kNumericalFloor * frame_.longest)),
        stop_(smallest_ > kNumericalFloor * frame_.longest ? StopReason::min_radius
                                                           : StopReason::numerical_floor),
        cap_(options.max_radius / frame_.scale),
        most_(2 * std::min(options.spheres, kMaxSpheres) + kFinishedBand),
        space_(distance_, smallest_,
               kBlocks + kBlocksPerSphere * std::min(options.spheres, kMaxSpheres)) {
    if (options.inertia_error > 0) no_inertia_.emplace(solid);
    if (!(volume_ > 0))
      refuse("the solid has no volume", {}, "check that its triangles face outward");
  }

  PackResult run() {
    double radius = std::min<double>(space_.bound(), cap_);
    while (!enough() && radius > smallest_) {
      radius = next_radius(radius);
      const std::size_t before = space_.spheres().size();
      if (is_nearly_full()) {
        const std::size_t wanted = std::min(options_.spheres, kMaxSpheres);
        fill_roughly(space_, radius, cap_, wanted, radius <= smallest_);
      } else {
        fill_band(space_, radius, cap_, most_);
      }
      for (std::size_t i = before; i < space_.spheres().size(); ++i)
        filled_ += volume(frame_.to_solid(space_.spheres()[i]));
      if (options_.progress) options_.progress(fraction());
    }
    return result();
  }

 private:
  bool is_nearly_full() const { return filled_ >= kNearlyFull * volume_; }
  // Returns the smallest radius of the band after the one down to `radius`.
  double next_radius(double radius) const {
    const double bound = std::min<double>(radius, space_.bound());
    const double band = space_.spheres().size() < kFirstSpheres ? kFirstBand : kLaterBand;
    const double next =
        is_nearly_full() ? std::min(radius, kRoughBand * space_.bound()) : band * bound;
    return std::max(smallest_, next);
  }
  // Returns the part of the work that is done, taking all spheres as equally costly. The uncovered
  // volume falls with their number.
  double fraction() const {
    const double number =
        static_cast<double>(space_.spheres().size()) / static_cast<double>(options_.spheres);
    const double left = (1 - options_.coverage) / (1 - std::min(filled_ / volume_, 0.999999));
    return std::min(1.0, std::max(number, std::pow(left, kApollonianPower)));
  }
  bool enough() const {
    return space_.spheres().size() >= options_.spheres || filled_ >= options_.coverage * volume_ ||
           (options_.inertia_error > 0 && result().stop == StopReason::inertia_error);
  }

  // Sorts all spheres and cuts to the number asked for; bands are complete, so the largest do not
  // depend on that number.
  PackResult result() const {
    std::vector<Sphere> all;
    for (const Sphere& s : space_.spheres())
      if (const Sphere m = frame_.to_solid(s); m.radius > 0) all.push_back(m);
    std::sort(all.begin(), all.end(), largest_first);
    PackResult result;
    result.stop = stop_;
    double filled = 0;
    std::optional<InertiaError> inertia = no_inertia_;
    for (const Sphere& s : all) {
      filled += volume(s);
      if (inertia) inertia->add(s);
      result.spheres.push_back(s);
      if (filled >= options_.coverage * volume_) {
        result.stop = StopReason::coverage;
      } else if (inertia && inertia->value() <= options_.inertia_error) {
        result.stop = StopReason::inertia_error;
      } else if (result.spheres.size() == options_.spheres) {
        result.stop = StopReason::spheres;
      } else {
        continue;
      }
      break;
    }
    const double least =
        result.spheres.empty() ? smallest_ : result.spheres.back().radius / frame_.scale;
    result.partly_searched =
        filled < kNearlyFull * volume_ && space_.left_out() > kMuchLarger * least;
    result.coverage = filled / volume_;
    if (!all.empty()) {
      const auto count = static_cast<double>(result.spheres.size());
      result.coverage_bound = std::min(1.0, count * volume(all.front()) / volume_);
    }
    return result;
  }

  const PackOptions& options_;
  SolidDistance distance_;
  UnitFrame frame_;
  double volume_;  // m^3
  // State before the first sphere; set if the inertia error is asked for.
  std::optional<InertiaError> no_inertia_;
  double smallest_;  // in the unit frame, as is cap_
  // Why packing stops if no request is met before.
  StopReason stop_;
  double cap_;
  std::size_t most_;  // number of spheres at which even a band is cut short
  Space space_;
  double filled_ = 0;  // m^3
};

}  // namespace

PackResult pack(const Solid& solid, const PackOptions& options) {
  check(options);
  return Packer(solid, options).run();
}

}  // namespace vpm
