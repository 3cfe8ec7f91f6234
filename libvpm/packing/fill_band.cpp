#include "libvpm/packing/fill_band.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "libvpm/core/parallel.h"
#include "libvpm/model/sphere.h"
#include "libvpm/packing/ascent.h"
#include "libvpm/packing/space.h"

namespace vpm {
namespace {

constexpr std::size_t kBlocksPerTask = 4;
// Number of new spheres that a block is searched for at a time. A block is at most four radii wide,
// so that more would mostly overlap.
constexpr std::size_t kAllOfBlock = std::numeric_limits<std::size_t>::max(), kFewOfBlock = 2;
// Spheres shrunk by others of their round by more than rounding are searched for again.
constexpr double kUnchanged = 1 - 1e-9;
// Widest gap to close, in radii. Wider ones hold another, closer candidate, or are not along a
// tube.
constexpr double kWidestGap = 1;
// Limit on the ascent back to the tube's axis, relative to the step: a step towards contact leaves
// the axis by less, so a longer ascent would wander along the axis.
constexpr double kAstray = 0.3;
constexpr double kStep = 0.3;      // largest step, in radii
constexpr double kContact = 1e-6;  // gap that counts as contact, in radii
constexpr double kNearer = 0.9;    // a step that leaves more than this part of the gap is given up
constexpr int kMaxSteps = 30;

// Spheres of one band of radii that were found and may be placed.
class Candidates {
 public:
  // Collects spheres of at least `radius`, cut to `cap`, and of each block so many at a time. Keeps
  // a reference to `space`.
  Candidates(Space& space, double radius, double cap, std::size_t of_block)
      : space_(space), radius_(radius), cap_(cap), of_block_(of_block) {}

  // Adds the spheres that fit above these blocks.
  void search(const std::vector<std::uint32_t>& blocks);

  bool empty() const { return candidates_.empty(); }

  // Places all candidates, largest first, until there are `most` spheres; drops those whose room is
  // taken by then. Appends the blocks around them to `touched`.
  void place_all(std::size_t most, std::vector<std::uint32_t>& touched);

  // Places the candidate with the smallest gap to a sphere, and moves it into contact if that costs
  // no more than the width of the band. In a tube the largest sphere fits anywhere, and the room
  // between two that do not touch would hold no third.
  void place_closest(std::vector<std::uint32_t>& touched);

 private:
  struct Candidate {
    Sphere sphere;
    double gap;           // distance to the nearest of the first `compared` spheres
    std::size_t nearest;  // its index
    std::size_t compared;
  };

  void update_gap(Candidate& candidate) const;
  Sphere moved_to_contact(const Candidate& candidate) const;
  bool place(const Sphere& sphere, std::vector<std::uint32_t>& touched);

  Space& space_;
  double radius_, cap_;
  std::size_t of_block_;
  std::vector<Candidate> candidates_;  // largest first
};

void Candidates::search(const std::vector<std::uint32_t>& blocks) {
  std::vector<std::vector<Sphere>> found(blocks.size());
  parallel_for(blocks.size(), kBlocksPerTask, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      space_.search(blocks[i], radius_, cap_, of_block_, found[i]);
  });
  for (const auto& some : found)
    for (const Sphere& s : some) candidates_.push_back({s, HUGE_VAL, 0, 0});
  std::sort(candidates_.begin(), candidates_.end(), [](const Candidate& a, const Candidate& b) {
    return largest_first(a.sphere, b.sphere);
  });
}

void Candidates::place_all(std::size_t most, std::vector<std::uint32_t>& touched) {
  for (const Candidate& c : candidates_)
    if (space_.spheres().size() < most) place(c.sphere, touched);
  candidates_.clear();
}

void Candidates::place_closest(std::vector<std::uint32_t>& touched) {
  bool placed = false;
  while (!placed && !candidates_.empty()) {
    for (Candidate& c : candidates_) update_gap(c);
    std::erase_if(candidates_,
                  [](const auto& c) { return c.gap < (kUnchanged - 1) * c.sphere.radius; });
    if (candidates_.empty()) return;
    const auto closest =
        std::min_element(candidates_.begin(), candidates_.end(),
                         [](const auto& a, const auto& b) { return a.gap < b.gap; });
    placed = place(moved_to_contact(*closest), touched);
    candidates_.erase(closest);
  }
}

void Candidates::update_gap(Candidate& c) const {
  for (; c.compared < space_.spheres().size(); ++c.compared) {
    const Sphere& s = space_.spheres()[c.compared];
    const double gap = norm(c.sphere.center - s.center) - s.radius - c.sphere.radius;
    if (gap < c.gap) {
      c.gap = gap;
      c.nearest = c.compared;
    }
  }
}

Sphere Candidates::moved_to_contact(const Candidate& c) const {
  Sphere best = c.sphere;
  if (c.gap > kWidestGap * best.radius) return best;
  const Sphere& to = space_.spheres()[c.nearest];
  double gap = c.gap;
  for (int i = 0; i < kMaxSteps && gap > kContact * best.radius; ++i) {
    const double step = std::min(gap, kStep * best.radius);
    const Vec3 x = best.center + normalized_or_zero(to.center - best.center) * step;
    const SeparationBound at = space_.separation(x);
    if (!(at.value > 0)) break;
    const Sphere moved = ascend(space_, x, at, kAstray * step);
    const double left = norm(moved.center - to.center) - to.radius - moved.radius;
    if (moved.radius < radius_ || left > kNearer * gap) break;
    best = {moved.center, std::min(moved.radius, cap_)};
    gap = left;
  }
  return best;
}

bool Candidates::place(const Sphere& sphere, std::vector<std::uint32_t>& touched) {
  const double room = space_.separation(sphere.center).value;
  if (!(room >= kUnchanged * sphere.radius)) return false;
  space_.place({sphere.center, std::min(room, sphere.radius)}, touched);
  return true;
}

// Fills these blocks, and those around each sphere that is placed, until no candidate is left. The
// first `in_contact` spheres of the packing are placed into contact.
void fill_blocks(Space& space, Candidates& candidates, std::vector<std::uint32_t> blocks,
                 double radius, std::size_t most, std::size_t in_contact) {
  while ((!blocks.empty() || !candidates.empty()) && space.spheres().size() < most) {
    candidates.search(blocks);
    if (space.spheres().size() < in_contact) {
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

}  // namespace

// Searches as many blocks per round as spheres are wanted.
void fill_band(Space& space, double radius, double cap, std::size_t most) {
  while (space.spheres().size() < most) {
    std::vector<std::uint32_t> blocks = space.focus(radius, most);
    if (blocks.empty()) return;
    Candidates candidates(space, radius, cap, kAllOfBlock);
    fill_blocks(space, candidates, std::move(blocks), radius, most, kFirstSpheres);
  }
}

void fill_roughly(Space& space, double radius, double cap, std::size_t most, bool until_none_fits) {
  do {
    std::vector<std::uint32_t> blocks = space.focus(radius, most);
    if (blocks.empty()) return;
    Candidates candidates(space, radius, cap, kFewOfBlock);
    fill_blocks(space, candidates, std::move(blocks), radius, most, 0);
  } while (until_none_fits && space.spheres().size() < most);
}

}  // namespace vpm
