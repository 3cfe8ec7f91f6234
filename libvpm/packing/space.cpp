#include "libvpm/packing/space.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <tuple>
#include <utility>

#include "libvpm/core/parallel.h"
#include "libvpm/packing/ascent.h"

namespace vpm {
namespace {

// Blocks wider than this many radii are cut; so they are 2 to 4 radii wide.
constexpr double kBlockWidth = 4;
// Distance, in widths of a block, up to which it lists spheres. The sought radius is at most half
// the width; the rest is for maxima that a search of a larger radius missed.
constexpr double kListDistance = 0.6;
constexpr double kRootListDistance = 2;  // above the cube's diagonal
// Cells with a half diagonal below this part of the radius are searched instead of cut.
constexpr float kLeaf = 0.25f;
// A leaf nearer to a known local maximum than this many of its half diagonals lies on its slope.
constexpr double kSlope = 2.5;
constexpr std::size_t kBlocksPerTask = 8, kSpheresPerTask = 8;
// Number of blocks that a task looks through, and of ranges of blocks that list new spheres.
constexpr std::size_t kNumbersPerTask = 1 << 11, kRanges = 64;
constexpr std::size_t kBlocksAround = 64;  // that list a sphere, mostly
// A block gives back memory when more than 1 / kUnusedPart of its cells' is unused, and takes 1 /
// kSparePart more than it needs.
constexpr std::size_t kUnusedPart = 4, kSparePart = 8;

// Returns the numbers of all lists, one list after the other.
std::vector<std::uint32_t> joined(const std::vector<std::vector<std::uint32_t>>& lists) {
  std::vector<std::uint32_t> all;
  for (const auto& list : lists) all.insert(all.end(), list.begin(), list.end());
  return all;
}

// Returns those of so many numbers, in their order, for which `holds`; number(k) is the k-th.
template <class Number, class Holds>
std::vector<std::uint32_t> those_for_which(std::size_t count, const Number& number,
                                           const Holds& holds) {
  std::vector<std::vector<std::uint32_t>> found(count / kNumbersPerTask + 1);
  parallel_for(found.size(), 1, [&](std::size_t task, std::size_t) {
    const std::size_t end = std::min((task + 1) * kNumbersPerTask, count);
    for (std::size_t k = task * kNumbersPerTask; k < end; ++k) {
      const auto candidate = static_cast<std::uint32_t>(number(k));
      if (holds(candidate)) found[task].push_back(candidate);
    }
  });
  return joined(found);
}

// Returns the sphere of radius `cap` that touches the nearest obstacle of x.
Sphere against_obstacle(Vec3 x, const SeparationBound& at, double cap) {
  return {x - (at.value - cap) * at.away, cap};
}

}  // namespace

Space::Space(const SolidDistance& solid, double smallest, std::size_t most_blocks)
    : solid_(solid),
      smallest_(static_cast<float>(smallest)),
      most_blocks_(most_blocks),
      room_(solid, spheres_, smallest_) {
  Block& whole = blocks_.emplace_back();
  whole.listed.distance = kRootListDistance;
  whole.cells = {room_.root(whole.listed)};
  bounds_ = {whole.cells.front().bound};
}

Space::~Space() {
  parallel_for(blocks_.size(), kNumbersPerTask, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) blocks_[b] = {};
  });
}

float Space::bound() const {
  std::vector<float> largest(bounds_.size() / kNumbersPerTask + 1);
  parallel_for(largest.size(), 1, [&](std::size_t task, std::size_t) {
    const std::size_t end = std::min((task + 1) * kNumbersPerTask, bounds_.size());
    for (std::size_t b = task * kNumbersPerTask; b < end; ++b)
      largest[task] = std::max(largest[task], bounds_[b]);
  });
  return *std::max_element(largest.begin(), largest.end());
}

std::vector<std::uint32_t> Space::focus(double radius, std::size_t most) {
  focus_ = radius;
  leave_out();
  for (;;) {
    std::vector<std::uint32_t> blocks = promising(radius);
    update(blocks);  // with the spheres placed while they rested
    const auto those = [&](const auto& holds) {
      return those_for_which(
          blocks.size(), [&](std::size_t k) { return blocks[k]; }, holds);
    };
    const auto has_hope = [&](std::uint32_t b) { return is_promising(b, radius); };
    blocks = those(has_hope);
    if (blocks.empty()) return blocks;
    for (;;) {
      keep_most_room(blocks, most);
      const std::vector<std::uint32_t> wide = those([&](std::uint32_t b) { return !is_cut(b); });
      if (wide.empty()) break;
      const std::vector<std::uint32_t> cut = those([&](std::uint32_t b) { return is_cut(b); });
      const std::vector<std::uint32_t> parts = split_blocks(wide);
      blocks.clear();
      std::merge(cut.begin(), cut.end(), parts.begin(), parts.end(), std::back_inserter(blocks));
      blocks = those(has_hope);
    }
    if (!blocks.empty()) return blocks;
  }
}

// Returns the blocks, ascending, that may still hold a sphere of this radius.
std::vector<std::uint32_t> Space::promising(double radius) const {
  return those_for_which(
      bounds_.size(), [](std::size_t k) { return k; },
      [&](std::uint32_t b) { return is_promising(b, radius); });
}

// Returns true if the block is small enough for searches.
bool Space::is_cut(std::uint32_t block) const {
  const int level = tree_[block].level;
  return edge_of_level(level) <= kBlockWidth * focus_ || level == BlockTree::kMaxLevel;
}

// Keeps at most so many blocks, ascending.
void Space::keep_most_room(std::vector<std::uint32_t>& blocks, std::size_t most) const {
  if (blocks.size() <= most) return;
  const auto rank = [&](std::uint32_t b) {
    return std::tuple(-bounds_[b], tree_[b].scattered(), b);
  };
  const auto cut = blocks.begin() + static_cast<std::ptrdiff_t>(most);
  std::nth_element(blocks.begin(), cut, blocks.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return rank(a) < rank(b); });
  blocks.erase(cut, blocks.end());
  std::sort(blocks.begin(), blocks.end());
}

void Space::split_cells(Block& block, int level, std::vector<Cell>& cells) const {
  for (Cell& cell : block.cells) {
    if (cell.level != level) {
      cells.push_back(cell);
      continue;
    }
    if (!cell.measured) room_.measure(cell);  // estimates from estimates would exclude nothing
    if (cell.side == Side::unknown && cell.mesh > half_diagonal(cell.level))
      room_.find_side(cell, block.listed);
    room_.bound_narrow_part(cell, block.listed);
    if (cell.bound > smallest_) room_.split(cell, block.listed, cells);
  }
}

// Returns the eighths of a block that have cells, and takes its contents.
Space::Parts Space::split_block(std::uint32_t number) {
  Block& block = blocks_[number];
  const BlockTree::Cube cube = tree_[number];
  const Vec3 center = cube.center();
  const double list_distance = kListDistance * edge_of_level(cube.level + 1);
  const double near = list_distance + half_diagonal(cube.level + 1);
  std::vector<Cell> cells;
  split_cells(block, cube.level, cells);
  const auto octant_of = [&](const Cell& cell) {
    return (cell.x > center.x ? 1u : 0u) + (cell.y > center.y ? 2u : 0u) +
           (cell.z > center.z ? 4u : 0u);
  };
  std::array<std::size_t, 8> counts{};
  for (const Cell& cell : cells) ++counts[octant_of(cell)];
  Parts parts;
  for (unsigned octant = 0; octant < 8; ++octant) {
    if (counts[octant] == 0) continue;
    parts.kept |= 1u << octant;
    Block& part = parts.blocks.emplace_back();
    part.listed.distance = list_distance;
    part.cells.reserve(counts[octant]);
    std::copy_if(cells.begin(), cells.end(), std::back_inserter(part.cells),
                 [&](const Cell& cell) { return octant_of(cell) == octant; });
    const Vec3 at = cube.part(octant).center();
    for (const std::uint32_t i : block.listed.spheres)
      if (norm(at - spheres_[i].center) - spheres_[i].radius < near)
        part.listed.spheres.push_back(i);
    part.listed.spheres.shrink_to_fit();
    part.taken = part.listed.spheres.size();
  }
  block.cells.clear();
  block.maxima.clear();
  return parts;
}

// Cuts blocks, whose numbers ascend, into eighths, and returns the numbers of all eighths, which
// ascend too. Blocks without any room stay whole, without cells.
std::vector<std::uint32_t> Space::split_blocks(const std::vector<std::uint32_t>& wide) {
  std::vector<Parts> parts(wide.size());
  parallel_for(wide.size(), kBlocksPerTask, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) parts[i] = split_block(wide[i]);
  });
  std::vector<std::uint32_t> numbers;
  std::vector<std::uint32_t> second;  // number of each block's second part, which others follow
  for (std::size_t i = 0; i < wide.size(); ++i) {
    bounds_[wide[i]] = 0;
    second.push_back(tree_.size());
    if (parts[i].kept == 0) continue;
    numbers.push_back(wide[i]);
    tree_.cut(wide[i], parts[i].kept);
  }
  for (auto b = static_cast<std::uint32_t>(blocks_.size()); b < tree_.size(); ++b)
    numbers.push_back(b);
  blocks_.resize(tree_.size());
  bounds_.resize(tree_.size());
  parallel_for(wide.size(), kBlocksPerTask, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      std::uint32_t b = wide[i], next = second[i];
      for (Block& part : std::exchange(parts[i].blocks, {})) {
        bounds_[b] = block_bound(part);
        blocks_[b] = std::move(part);
        b = next++;
      }
    }
  });
  return numbers;
}

// Drops blocks without room, then those of thin plates, which have more than memory holds, all with
// equal room. Those that stay are spread over the plate. Waits until there are a quarter too many,
// since each time costs a look at all.
void Space::leave_out() {
  if (blocks_.size() <= most_blocks_ + most_blocks_ / 4) return;
  std::vector<std::uint32_t> order;
  for (std::uint32_t b = 0; b < blocks_.size(); ++b)
    if (!blocks_[b].cells.empty()) order.push_back(b);
  if (order.size() > most_blocks_) {
    // Bounds are loose until a block is searched: differences below a factor of two tell nothing.
    const float most_room = bound();
    const auto rank = [&](std::uint32_t b) {
      return std::tuple(2 * bounds_[b] < most_room, tree_[b].scattered(), b);
    };
    const auto cut = order.begin() + static_cast<std::ptrdiff_t>(most_blocks_);
    std::nth_element(order.begin(), cut, order.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return rank(a) < rank(b); });
    std::for_each(cut, order.end(),
                  [&](std::uint32_t b) { left_out_ = std::max(left_out_, bounds_[b]); });
    order.erase(cut, order.end());
    std::sort(order.begin(), order.end());
  }
  keep(order);
}

// Keeps only these blocks, ascending, and numbers them anew.
void Space::keep(const std::vector<std::uint32_t>& blocks) {
  for (std::uint32_t to = 0; to < blocks.size(); ++to) {
    const std::uint32_t from = blocks[to];
    if (from == to) continue;
    blocks_[to] = std::move(blocks_[from]);
    bounds_[to] = bounds_[from];
  }
  blocks_.resize(blocks.size());
  bounds_.resize(blocks.size());
  tree_.keep(blocks);
}

float Space::block_bound(const Block& block) {
  float bound = 0;
  for (const Cell& cell : block.cells) bound = std::max(bound, cell.bound);
  return bound;
}

// Takes the promising cells out of a block and cuts them down to `leaves`; adds all others to
// `rest`. Cells that are not promising stay where they are: a block is searched for one band of
// radii after the other, and each time few of its cells are.
void Space::refine(Block& block, double radius, double cap, Scratch& scratch) const {
  auto& [leaves, rest, pending, planes] = scratch;
  const auto promising = std::partition(block.cells.begin(), block.cells.end(),
                                        [&](const Cell& cell) { return cell.bound < radius; });
  pending.assign(promising, block.cells.end());
  block.cells.erase(promising, block.cells.end());
  while (!pending.empty()) {
    Cell cell = pending.back();
    pending.pop_back();
    const float half = half_diagonal(cell.level);
    if (cell.bound >= radius && !cell.measured) room_.measure(cell);
    if (cell.bound < radius) {
      if (cell.bound > smallest_) rest.push_back(cell);
      continue;
    }
    if (cell.side == Side::unknown) room_.find_side(cell, block.listed);
    if (cell.side == Side::inside && cell.d > 0 && cell.d < radius)
      room_.bound_jointly(cell, block.listed, planes);
    if (cell.bound < radius) {
      if (cell.bound > smallest_) rest.push_back(cell);
      continue;
    }
    if (cell.side == Side::inside && (cell.d >= cap || half <= kLeaf * radius)) {
      leaves.push_back(cell);
      continue;
    }
    room_.bound_narrow_part(cell, block.listed);
    if (cell.bound >= radius) {
      room_.split(cell, block.listed, pending);
    } else if (cell.bound > smallest_) {
      rest.push_back(cell);
    }
  }
}

void Space::search(std::uint32_t number, double radius, double cap, std::size_t most,
                   std::vector<Sphere>& found) {
  Block& block = blocks_[number];
  static thread_local Scratch scratch;  // getting memory anew would take a tenth of all time
  auto& [leaves, rest, pending, planes] = scratch;
  leaves.clear(), rest.clear();
  refine(block, radius, cap, scratch);
  std::sort(leaves.begin(), leaves.end(), [](const Cell& a, const Cell& b) {
    if (a.d != b.d) return a.d > b.d;
    if (a.x != b.x) return a.x < b.x;
    if (a.y != b.y) return a.y < b.y;
    return a.z < b.z;
  });
  std::size_t ascended = 0;  // number of new maxima of at least `radius`
  for (Cell& leaf : leaves) {
    const std::size_t known = block.maxima.size();
    const double maximum = ascended < most ? local_maximum(block, leaf, radius, cap) : radius;
    if (maximum < radius) {
      leaf.bound = std::min({leaf.bound, static_cast<float>(maximum),
                             std::nextafter(static_cast<float>(radius), 0.0f)});
    } else if (block.maxima.size() > known) {
      ++ascended;
    }
  }
  const std::size_t count = block.cells.size() + leaves.size() + rest.size();
  if (block.cells.capacity() < count) block.cells.reserve(count + count / kSparePart);
  block.cells.insert(block.cells.end(), leaves.begin(), leaves.end());
  block.cells.insert(block.cells.end(), rest.begin(), rest.end());
  if (block.cells.capacity() > count + count / kUnusedPart) block.cells.shrink_to_fit();
  bounds_[number] = block_bound(block);
  std::erase_if(block.maxima, [&](const Sphere& m) {
    if (m.radius < radius) return false;
    found.push_back(m);
    return true;
  });
}

// Returns the radius of the local maximum above a leaf, and adds a new one to the block's maxima.
double Space::local_maximum(Block& block, const Cell& leaf, double radius, double cap) const {
  const Vec3 x = leaf.center();
  const float half = half_diagonal(leaf.level);
  for (const Sphere& m : block.maxima) {
    const double distance = norm(x - m.center);
    // The leaf lies on the slope of this maximum, or has no room left once that is placed.
    if (distance < kSlope * half && leaf.d <= m.radius) return m.radius;
    if (m.radius >= radius && distance - m.radius + half < radius) return m.radius;
  }
  const SeparationBound at = separation(x);
  Sphere best = at.value >= cap ? against_obstacle(x, at, cap) : ascend(*this, x, at);
  best.radius = std::min(best.radius, cap);
  block.maxima.push_back(best);
  return best.radius;
}

SeparationBound Space::separation(Vec3 x, double within) const {
  const std::uint32_t b = tree_.find(x);
  if (b == BlockTree::kNone) return {-1, {}, {}};
  SeparationBound best{std::min(within, blocks_[b].listed.distance), {}, {}};
  for (const std::uint32_t i : blocks_[b].listed.spheres) {
    const Vec3 from = x - spheres_[i].center;
    if (is_beyond(from, spheres_[i].radius, best.value)) continue;
    const double d = norm(from) - spheres_[i].radius;
    if (d < best.value) best = {d, {Obstacle::Kind::sphere, i}, {}};
  }
  if (best.value > 0) {
    if (const SurfacePoint p = solid_.closest(x, best.value); p.triangle != SurfacePoint::kNone) {
      return {p.distance, {Obstacle::Kind::triangle, p.triangle}, normalized_or_zero(x - p.point)};
    }
  }
  if (best.nearest.kind == Obstacle::Kind::sphere)
    best.away = normalized_or_zero(x - spheres_[best.nearest.index].center);
  return best;
}

std::vector<std::uint32_t> Space::place(std::span<const Sphere> spheres) {
  const auto first = static_cast<std::uint32_t>(spheres_.size());
  spheres_.insert(spheres_.end(), spheres.begin(), spheres.end());
  std::vector<std::vector<std::uint32_t>> around(spheres.size());
  parallel_for(spheres.size(), kSpheresPerTask, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) around[i] = blocks_around(spheres[i]);
  });
  // Each task lists the spheres, in order, in the blocks of a range of its own.
  std::vector<std::vector<std::uint32_t>> touched(kRanges);
  parallel_for(kRanges, 1, [&](std::size_t range, std::size_t) {
    struct Listing {
      std::uint32_t block, sphere;
    };
    const std::size_t low = range * blocks_.size() / kRanges,
                      high = (range + 1) * blocks_.size() / kRanges;
    std::vector<Listing> listings;
    for (std::uint32_t i = 0; i < around.size(); ++i)
      for (const std::uint32_t b : around[i])
        if (b >= low && b < high) listings.push_back({b, first + i});
    for (const auto& [b, sphere] : listings) {
      blocks_[b].listed.spheres.push_back(sphere);
      if (is_promising(b, focus_) && is_cut(b)) touched[range].push_back(b);
    }
    std::sort(touched[range].begin(), touched[range].end());
    touched[range].erase(std::unique(touched[range].begin(), touched[range].end()),
                         touched[range].end());
  });
  return joined(touched);
}

// Returns the blocks that list a sphere.
std::vector<std::uint32_t> Space::blocks_around(const Sphere& sphere) const {
  const auto reach = [&](int level) {
    return sphere.radius + kListDistance * edge_of_level(level) + half_diagonal(level);
  };
  std::vector<std::uint32_t> around;
  around.reserve(kBlocksAround);
  tree_.visit(sphere.center, reach, [&](std::uint32_t b) { around.push_back(b); });
  return around;
}

void Space::update(const std::vector<std::uint32_t>& blocks) {
  parallel_for(blocks.size(), kBlocksPerTask, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Block& block = blocks_[blocks[i]];
      if (block.taken == block.listed.spheres.size()) continue;
      take_new(block);
      bounds_[blocks[i]] = block_bound(block);
    }
  });
}

// Takes the spheres listed since the last call from the room of a block.
void Space::take_new(Block& block) const {
  const std::span<const std::uint32_t> fresh = std::span(block.listed.spheres).subspan(block.taken);
  block.taken = block.listed.spheres.size();
  std::erase_if(block.cells, [&](Cell& cell) {
    for (const std::uint32_t i : fresh) CellRoom::take_from(cell, spheres_[i]);
    return cell.bound <= smallest_;
  });
  std::erase_if(block.maxima, [&](const Sphere& m) {
    return std::any_of(fresh.begin(), fresh.end(), [&](std::uint32_t i) {
      return norm(m.center - spheres_[i].center) - spheres_[i].radius < m.radius;
    });
  });
}

}  // namespace vpm
