#include "libvpm/mesh/work_limit.h"

#include <algorithm>
#include <numeric>
#include <vector>

#include "libvpm/core/parallel.h"

namespace vpm {
namespace {

constexpr std::size_t kFirstRound = 4;
// Work of a round, relative to the limit, below which the next round is twice as long.
constexpr std::uint64_t kSmallRound = 64;
// Ranges of a round that threads share.
constexpr std::size_t kRanges = 64;

}  // namespace

bool run_within(WorkLimit& limit, std::size_t count,
                const std::function<std::uint64_t(std::size_t)>& work_of,
                const MeshProgress& progress) {
  std::vector<std::uint64_t> work;
  std::size_t round = kFirstRound;
  for (std::size_t begin = 0; begin < count;) {
    const std::size_t size = std::min(round, count - begin);
    work.assign(size, 0);
    parallel_for(size, 1 + size / kRanges, [&](std::size_t first, std::size_t last) {
      for (std::size_t k = first; k < last; ++k) work[k] = work_of(begin + k);
    });
    begin += size;
    const std::uint64_t done = std::accumulate(work.begin(), work.end(), std::uint64_t{0});
    if (!limit.spend(done)) return false;
    if (done < limit.most() / kSmallRound) {
      round *= 2;
    } else if (done > 2 * (limit.most() / kSmallRound)) {
      round = std::max(kFirstRound, round / 2);
    }
    if (progress) progress(static_cast<double>(begin) / static_cast<double>(count));
  }
  return true;
}

}  // namespace vpm
