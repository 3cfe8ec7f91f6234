#include "libvpm/packing/fill_band.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <utility>
#include <vector>

#include "libvpm/core/box.h"
#include "libvpm/core/parallel.h"
#include "libvpm/model/sphere.h"
#include "libvpm/packing/ascent.h"
#include "libvpm/packing/space.h"

namespace vpm {
namespace {

constexpr std::size_t kBlocksPerTask = 4, kSpheresPerTask = 16;
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

// Lists for each sphere those before it, by index, that it overlaps. The largest must be first.
std::vector<std::vector<std::uint32_t>> overlapped_before(const std::vector<Sphere>& spheres) {
  struct Sorted {
    double at;  // coordinate of the centre along the sweep
    std::uint32_t index;
  };
  Box box;
  for (const Sphere& s : spheres) box.add(s.center);
  const int axis = box.longest_axis();
  std::vector<Sorted> order;
  for (const Sphere& s : spheres)
    order.push_back({coordinate(s.center, axis), static_cast<std::uint32_t>(order.size())});
  std::sort(order.begin(), order.end(), [](const Sorted& a, const Sorted& b) {
    return a.at != b.at ? a.at < b.at : a.index < b.index;
  });
  std::vector<std::vector<std::uint32_t>> overlapped(spheres.size());
  parallel_for(order.size(), kSpheresPerTask, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) {
      const std::uint32_t i = order[p].index;
      const double reach = spheres[i].radius + spheres.front().radius;
      const auto take = [&](std::uint32_t j) {
        const double distance = norm(spheres[i].center - spheres[j].center);
        if (j < i && distance - spheres[j].radius < spheres[i].radius) overlapped[i].push_back(j);
      };
      for (std::size_t q = p; q-- > 0 && order[p].at - order[q].at <= reach;) take(order[q].index);
      for (std::size_t q = p + 1; q < order.size() && order[q].at - order[p].at <= reach; ++q)
        take(order[q].index);
    }
  });
  return overlapped;
}

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
  // taken by then. Returns the blocks around them, ascending.
  std::vector<std::uint32_t> place_all(std::size_t most);

  // Places the candidate with the smallest gap to a sphere, and moves it into contact if that costs
  // no more than the width of the band. In a tube the largest sphere fits anywhere, and the room
  // between two that do not touch would hold no third. Returns the blocks around it, ascending.
  std::vector<std::uint32_t> place_closest();

 private:
  struct Candidate {
    Sphere sphere;
    double gap;           // distance to the nearest of the first `compared` spheres
    std::size_t nearest;  // its index
    std::size_t compared;
  };

  void update_gap(Candidate& candidate) const;
  Sphere moved_to_contact(const Candidate& candidate) const;
  std::vector<Sphere> fitting(const std::vector<Sphere>& spheres, std::size_t most) const;

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

std::vector<std::uint32_t> Candidates::place_all(std::size_t most) {
  std::vector<Sphere> spheres;
  for (const Candidate& c : candidates_) spheres.push_back(c.sphere);
  candidates_.clear();
  return space_.place(fitting(spheres, most - space_.spheres().size()));
}

std::vector<std::uint32_t> Candidates::place_closest() {
  std::vector<Sphere> fits;
  while (fits.empty() && !candidates_.empty()) {
    for (Candidate& c : candidates_) update_gap(c);
    std::erase_if(candidates_,
                  [](const auto& c) { return c.gap < (kUnchanged - 1) * c.sphere.radius; });
    if (candidates_.empty()) break;
    const auto closest =
        std::min_element(candidates_.begin(), candidates_.end(),
                         [](const auto& a, const auto& b) { return a.gap < b.gap; });
    fits = fitting({moved_to_contact(*closest)}, 1);
    candidates_.erase(closest);
  }
  return space_.place(fits);
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

// Returns the first `most` of these spheres that fit, after each other, beside those placed so far,
// each cut by what rounding took of its room. The largest must be first.
std::vector<Sphere> Candidates::fitting(const std::vector<Sphere>& spheres,
                                        std::size_t most) const {
  std::vector<double> rooms(spheres.size());
  parallel_for(spheres.size(), kSpheresPerTask, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) rooms[i] = space_.separation(spheres[i].center).value;
  });
  const auto fits = [](double room, const Sphere& s) { return room >= kUnchanged * s.radius; };
  std::vector<Sphere> open;  // those that fit unless one before them takes their room
  std::vector<double> open_rooms;
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    if (!fits(rooms[i], spheres[i])) continue;
    open.push_back(spheres[i]);
    open_rooms.push_back(rooms[i]);
  }
  const std::vector<std::vector<std::uint32_t>> overlapped = overlapped_before(open);
  std::vector<Sphere> fitting;
  for (std::size_t i = 0; i < open.size() && fitting.size() < most; ++i) {
    double room = open_rooms[i];
    for (const std::uint32_t j : overlapped[i])  // of radius 0 if it does not fit itself
      if (open[j].radius > 0)
        room = std::min(room, norm(open[i].center - open[j].center) - open[j].radius);
    open[i].radius = fits(room, open[i]) ? std::min(room, open[i].radius) : 0;
    if (open[i].radius > 0) fitting.push_back(open[i]);
  }
  return fitting;
}

// Fills these blocks, and those around each sphere that is placed, until no candidate is left. The
// first `in_contact` spheres of the packing are placed into contact.
void fill_blocks(Space& space, Candidates& candidates, std::vector<std::uint32_t> blocks,
                 double radius, std::size_t most, std::size_t in_contact) {
  while ((!blocks.empty() || !candidates.empty()) && space.spheres().size() < most) {
    candidates.search(blocks);
    if (space.spheres().size() < in_contact) {
      blocks = candidates.place_closest();
    } else {
      const std::vector<std::uint32_t> searched = std::move(blocks);
      const std::vector<std::uint32_t> touched = candidates.place_all(most);
      blocks.clear();
      std::set_union(searched.begin(), searched.end(), touched.begin(), touched.end(),
                     std::back_inserter(blocks));
    }
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
