#include "tools/bench/errors.h"

#include <algorithm>

#include "libvpm/model/sphere.h"

namespace vpm::bench {
namespace {

double angle_degrees(Vec3 a, Vec3 b) {
  return std::atan2(norm(cross(a, b)), dot(a, b)) * 180 / kPi;
}

}  // namespace

double volume_error(double volume, double truth, const Unseen& unseen) {
  const double least = truth - unseen.inside, most = truth + unseen.free;
  return std::isnan(volume) ? volume : std::max({least - volume, volume - most, 0.0});
}

Errors compare(const std::vector<Result>& measured,
               const std::vector<synthetic::Penetration>& truth, const std::vector<Unseen>& unseen,
               const synthetic::TrueSolid& tool) {
  Errors errors;
  const double whole = tool.mass().volume;
  for (std::size_t k = 0; k < truth.size(); ++k) {
    const double volume = measured[k].volume / whole, true_volume = truth[k].volume / whole;
    errors.volume.add(volume_error(volume, true_volume, unseen[k]));
    if (unseen[k].foot <= kDepthKnown * true_volume &&
        unseen[k].free + unseen[k].inside <= kDepthKnown * true_volume) {
      const Vec3 force = measured[k].wrench.force, torque = measured[k].wrench.torque;
      errors.force.add(norm(force - truth[k].force) / whole);
      errors.torque.add(norm(torque - truth[k].torque) / (whole * tool.radius()));
      if (norm(truth[k].force) > kForceMatters * whole)
        errors.direction.add(angle_degrees(force, truth[k].force));
    }
    if (k == 0) continue;
    const double step = std::abs(volume - measured[k - 1].volume / whole);
    const double may_step = std::abs(true_volume - truth[k - 1].volume / whole) +
                            std::abs(unseen[k].free - unseen[k - 1].free) +
                            std::abs(unseen[k].inside - unseen[k - 1].inside);
    errors.jump.add(std::max(step - may_step, 0.0));
  }
  return errors;
}

nlohmann::json to_json(const Errors& e) {
  return {{"volume_mean", e.volume.mean()},
          {"volume_worst", e.volume.worst()},
          {"jump_worst", e.jump.worst()},
          {"force_mean", e.force.mean()},
          {"force_worst", e.force.worst()},
          {"force_poses", e.force.count()},
          {"direction_mean_degrees", e.direction.mean()},
          {"direction_worst_degrees", e.direction.worst()},
          {"torque_mean", e.torque.mean()},
          {"torque_worst", e.torque.worst()}};
}

void GroupErrors::add(const Errors& e) {
  volume.add(e.volume.mean());
  volume_worst.add(e.volume.worst());
  jump.add(e.jump.worst());
  torque.add(e.torque.mean());
  torque_worst.add(e.torque.worst());
  direction.add(e.direction.mean());
  direction_worst.add(e.direction.worst());
}

}  // namespace vpm::bench
