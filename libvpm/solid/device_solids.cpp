#include "libvpm/solid/device_solids.h"

#include <algorithm>
#include <deque>

#include "libvpm/core/parallel.h"

namespace vpm {
namespace {

constexpr std::size_t kJobsAtOnce = 32768, kJobsPerTask = 256;

// Returns what a device's sums mean, if they hold and close, and if they tell more than that the
// solids may only touch.
std::optional<SharedSolid> shared_of(const PairAnswer& answer, const Pose& relative,
                                     const OrderedPair& pair, const OrderedPair::Place& place) {
  if (answer.has_room == 0 || answer.undecided > 0) return std::nullopt;
  if (pair.unlikeness() > SolidPair::kMostUnlike) return std::nullopt;
  const double unit = unit_for(pair.first().reach(), pair.second().reach());
  std::array<InnerSurface, 2> inner;
  for (std::size_t role = 0; role < 2; ++role)
    inner[role].moments = SurfacePair::moments_of(answer.whole[role], answer.cut[role], unit,
                                                  role == 0 ? Pose{} : relative);
  const double gap = pair.closure(inner);
  if (!(gap <= SolidPair::kMaxClosure)) return std::nullopt;
  SharedSolid shared = pair.shared_of(inner);
  const double area = std::max(pair.first().area(), pair.second().area());
  if (shared.volume > 0 && shared.volume <= pair.volume_of_touch(area, place)) return std::nullopt;
  shared.closure = gap, shared.attempts = 1;
  return shared;
}

}  // namespace

DeviceSolids::DeviceSolids(const Device& device,
                           std::vector<std::shared_ptr<const SolidSurface>> solids)
    : solids_(std::move(solids)) {
  std::deque<SurfaceLists> lists;
  std::vector<SurfaceView> views;
  for (const auto& solid : solids_) views.push_back(lists.emplace_back(*solid).view());
  device_ = make_device_pairs(device, views);
}

const OrderedPair& DeviceSolids::pair_of(const SolidJob& job) {
  return pairs_.try_emplace({job.a, job.b}, solids_[job.a], solids_[job.b]).first->second;
}

std::vector<std::optional<SharedSolid>> DeviceSolids::run(std::span<const SolidJob> jobs) {
  std::vector<std::optional<SharedSolid>> answers(jobs.size());
  for (std::size_t begin = 0; begin < jobs.size(); begin += kJobsAtOnce) {
    const std::size_t count = std::min(kJobsAtOnce, jobs.size() - begin);
    run_part(jobs.subspan(begin, count), Answers(answers).subspan(begin, count));
  }
  return answers;
}

void DeviceSolids::run_part(std::span<const SolidJob> jobs, Answers answers) {
  struct Asked {
    const OrderedPair* pair;
    OrderedPair::Place place;
  };
  std::vector<Asked> asked(jobs.size());
  for (std::size_t k = 0; k < jobs.size(); ++k) {
    const bool is_as_before = k > 0 && jobs[k].a == jobs[k - 1].a && jobs[k].b == jobs[k - 1].b;
    asked[k].pair = is_as_before ? asked[k - 1].pair : &pair_of(jobs[k]);
  }
  std::vector<SurfaceJob> given(jobs.size());
  parallel_for(jobs.size(), kJobsPerTask, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const SolidJob& job = jobs[k];
      auto& [pair, place] = asked[k];
      place = pair->place(job.pose_a, job.pose_b);
      const bool a_is_first = &pair->first() == solids_[job.a].get();
      given[k] = {a_is_first ? job.a : job.b, a_is_first ? job.b : job.a, pair->moved(place, 0)};
    }
  });
  std::vector<PairAnswer> sums(jobs.size());
  device_->run(given, sums);
  parallel_for(jobs.size(), kJobsPerTask, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const auto& [pair, place] = asked[k];
      if (!pair->may_meet(place))
        answers[k].emplace();
      else if (auto shared = shared_of(sums[k], given[k].pose, *pair, place))
        answers[k] = OrderedPair::in_world(std::move(*shared), place);
    }
  });
}

}  // namespace vpm
