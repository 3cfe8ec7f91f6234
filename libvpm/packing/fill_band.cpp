#include "libvpm/packing/fill_band.h"

#include <algorithm>
#include <cstdint>
#include <vector>

#include "libvpm/packing/candidates.h"

namespace vpm {
namespace {

// Keeps the `most` blocks with the highest bounds, ascending.
void keep_most_promising(const Space& space, std::vector<std::uint32_t>& blocks, std::size_t most) {
  if (blocks.size() <= most) return;
  const auto cut = blocks.begin() + static_cast<std::ptrdiff_t>(most);
  std::nth_element(blocks.begin(), cut, blocks.end(), [&](std::uint32_t a, std::uint32_t b) {
    if (space.bound(a) != space.bound(b)) return space.bound(a) > space.bound(b);
    return a < b;
  });
  blocks.erase(cut, blocks.end());
  std::sort(blocks.begin(), blocks.end());
}

}  // namespace

// Searches as many blocks per round as spheres are wanted: a plate has millions of equally good
// blocks.
void fill_band(Space& space, double radius, double cap, std::size_t most) {
  while (space.spheres().size() < most) {
    std::vector<std::uint32_t> blocks = space.promising(radius);
    if (blocks.empty()) return;
    keep_most_promising(space, blocks, most);
    Candidates candidates(space, radius, cap);
    while (!blocks.empty() || !candidates.empty()) {
      candidates.search(blocks);
      if (space.spheres().size() == most) return;
      if (space.spheres().size() < kFirstSpheres) {
        blocks.clear();
        candidates.place_closest(blocks);
      } else {
        candidates.place_all(most, blocks);
      }
      std::sort(blocks.begin(), blocks.end());
      blocks.erase(std::unique(blocks.begin(), blocks.end()), blocks.end());
      space.update(blocks);
      std::erase_if(blocks, [&](std::uint32_t b) { return !space.is_promising(b, radius); });
    }
  }
}

}  // namespace vpm
