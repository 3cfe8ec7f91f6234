#include "libvpm/packing/outer_cover.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <queue>
#include <span>
#include <utility>

#include "libvpm/core/box.h"
#include "libvpm/core/error.h"
#include "libvpm/core/parallel.h"
#include "libvpm/graph/enclosing_sphere.h"
#include "libvpm/packing/solid_cells.h"

namespace vpm {
namespace {

// So many pieces are made for each sphere, and at least so many, which is as fine as it pays.
constexpr double kPiecesPerSphere = 96, kFewestPieces = 6000;
// Rounds of improvement. Each shrinks all spheres, then lets pieces change theirs.
constexpr int kRounds = 8;
constexpr int kShrinksPerRound = 2;

// The pieces of a solid, in the packer's frame. The balls of all stand in one list.
struct Pieces {
  std::vector<Sphere> balls;
  std::vector<std::size_t> begin{0};  // of each piece's balls, and one more
  std::vector<Sphere> around;         // each piece, loosely
  std::vector<double> volume;         // about

  std::size_t size() const { return around.size(); }
  std::span<const Sphere> of(std::uint32_t piece) const {
    return std::span(balls).subspan(begin[piece], begin[piece + 1] - begin[piece]);
  }
  // Returns how far the piece reaches beyond the sphere; 0 or less if it lies in it.
  double beyond(std::uint32_t piece, const Sphere& sphere) const {
    return enclosing_radius(sphere.center, of(piece)) - sphere.radius;
  }
  bool holds(const Sphere& sphere, std::uint32_t piece) const {
    const double from = norm(around[piece].center - sphere.center);
    if (from + around[piece].radius <= sphere.radius) return true;
    return from <= sphere.radius && beyond(piece, sphere) <= 0;
  }
};

void add_pieces(const SolidCells& cells, const Cell& cell, SolidCells::Place place, double size,
                std::vector<std::pair<Cell, SolidCells::Place>>& found) {
  if (place == SolidCells::Place::cut) place = cells.place(cell);
  if (place == SolidCells::Place::outside) return;
  if (cell.longest() <= size) {
    found.push_back({cell, place});
    return;
  }
  for (const Cell& half : cell.halves()) add_pieces(cells, half, place, size, found);
}

// Cuts the solid into pieces, each of at most `size` along every axis.
Pieces pieces_of(const SolidCells& cells, double size) {
  std::vector<std::pair<Cell, SolidCells::Place>> found;
  add_pieces(cells, cells.box(), SolidCells::Place::cut, size, found);
  std::vector<std::vector<Sphere>> hulls(found.size());
  // Twice the certificate's tolerance, so that what lies in a sphere here does there.
  const double slack = 2 * cells.tolerance();
  parallel_for(found.size(), 64, [&](std::size_t first, std::size_t last) {
    for (std::size_t k = first; k < last; ++k) {
      const auto& [cell, place] = found[k];
      if (place == SolidCells::Place::cut) {
        hulls[k] = cells.hull(cell, slack);
      } else {
        for (int corner = 0; corner < 8; ++corner) hulls[k].push_back({cell.corner(corner), slack});
      }
    }
  });
  Pieces pieces;
  for (std::size_t k = 0; k < found.size(); ++k) {
    if (hulls[k].empty()) continue;
    pieces.balls.insert(pieces.balls.end(), hulls[k].begin(), hulls[k].end());
    pieces.begin.push_back(pieces.balls.size());
    pieces.around.push_back(enclosing_sphere(hulls[k]));
    const bool is_cut = found[k].second == SolidCells::Place::cut;
    pieces.volume.push_back((is_cut ? 0.5 : 1) * found[k].first.volume());
  }
  return pieces;
}

// Returns a sphere that holds the pieces, within about 1 % of the smallest: that of few balls, to
// which the farthest of all is added until none is far outside.
Sphere sphere_about(const Pieces& pieces, std::span<const std::uint32_t> members) {
  constexpr int kSteps = 24;
  Box centers;
  for (const std::uint32_t piece : members) centers.add(pieces.around[piece].center);
  std::vector<Sphere> few;
  Sphere best{0.5 * (centers.low + centers.high), HUGE_VAL}, next{best.center, 0};
  for (int step = 0; step < kSteps; ++step) {
    Sphere farthest;
    double radius = 0;
    for (const std::uint32_t piece : members)
      for (const Sphere& ball : pieces.of(piece)) {
        const double reach = norm(ball.center - next.center) + ball.radius;
        if (reach > radius) radius = reach, farthest = ball;
      }
    const Sphere found{next.center, enclosing_radius(next.center, std::span(&farthest, 1))};
    if (found.radius < best.radius) best = found;
    if (radius <= next.radius * 1.001) break;
    few.push_back(farthest);
    next = enclosing_sphere(few);
  }
  return best;
}

// Pieces that lie in one sphere: all that no other sphere holds, at least.
struct Group {
  std::vector<std::uint32_t> members;
  Sphere sphere;
  double waste = 0;  // the sphere's volume without that of its pieces

  friend bool operator<(const Group& a, const Group& b) { return a.waste < b.waste; }
};

Group group_in(const Pieces& pieces, const Sphere& sphere, std::vector<std::uint32_t> members) {
  Group group{std::move(members), sphere, volume(sphere)};
  for (const std::uint32_t piece : group.members) group.waste -= pieces.volume[piece];
  if (group.members.size() < 2) group.waste = -1;  // cannot be divided
  return group;
}

Group group_of(const Pieces& pieces, std::vector<std::uint32_t> members) {
  const Sphere sphere = sphere_about(pieces, members);
  return group_in(pieces, sphere, std::move(members));
}

// Divides a group of two pieces or more by the nearer of two means, which begin at the middles of
// the halves of its box across the longest side.
std::array<std::vector<std::uint32_t>, 2> divided(const Pieces& pieces, const Group& group) {
  Vec3 low{HUGE_VAL, HUGE_VAL, HUGE_VAL}, high = -low;
  for (const std::uint32_t piece : group.members) {
    const Vec3 p = pieces.around[piece].center;
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  const std::array<Cell, 2> halves = Cell{low, high}.halves();
  constexpr int kMeans = 8;
  Vec3 a = halves[0].center(), b = halves[1].center();
  std::array<std::vector<std::uint32_t>, 2> parts;
  for (int step = 0; step < kMeans; ++step) {
    for (auto& part : parts) part.clear();
    std::array<Vec3, 2> sums;
    for (const std::uint32_t piece : group.members) {
      const Vec3 p = pieces.around[piece].center;
      const std::size_t to = squared_norm(p - b) < squared_norm(p - a) ? 1 : 0;
      parts[to].push_back(piece);
      sums[to] += p;
    }
    if (parts[0].empty() || parts[1].empty()) break;
    a = sums[0] / static_cast<double>(parts[0].size());
    b = sums[1] / static_cast<double>(parts[1].size());
  }
  if (parts[0].empty() || parts[1].empty()) {  // all at one place
    parts[0].assign(group.members.begin(), group.members.begin() + 1);
    parts[1].assign(group.members.begin() + 1, group.members.end());
  }
  return parts;
}

// Divides groups of pieces until there are `count`: each time the one whose sphere has the most
// volume beyond that of its pieces.
void divide_until(const Pieces& pieces, std::vector<Group>& groups, std::size_t count) {
  std::make_heap(groups.begin(), groups.end());
  while (groups.size() < count) {
    std::pop_heap(groups.begin(), groups.end());
    auto parts = divided(pieces, groups.back());
    groups.back() = group_of(pieces, std::move(parts[0]));
    std::push_heap(groups.begin(), groups.end());
    groups.push_back(group_of(pieces, std::move(parts[1])));
    std::push_heap(groups.begin(), groups.end());
  }
}

// Finds the pieces whose centres lie in a sphere, by a grid of cubes.
class PieceGrid {
 public:
  PieceGrid(const Pieces& pieces, double size) : pieces_(pieces), size_(size) {
    for (std::uint32_t k = 0; k < pieces.size(); ++k) places_.push_back({key(k), k});
    std::ranges::sort(places_);
  }

  template <class Visit>
  void near(const Sphere& sphere, Visit visit) const {
    const double reach = sphere.radius;
    const std::array<int, 3> low = cube(sphere.center - Vec3{reach, reach, reach}),
                             high = cube(sphere.center + Vec3{reach, reach, reach});
    for (int x = low[0]; x <= high[0]; ++x)
      for (int y = low[1]; y <= high[1]; ++y) {
        // Cubes that follow each other along z do so in the list, too.
        const std::array<int, 3> last{x, y, high[2]};
        for (auto place =
                 std::ranges::lower_bound(places_, std::pair{std::array{x, y, low[2]}, 0U});
             place != places_.end() && place->first <= last; ++place)
          if (squared_norm(pieces_.around[place->second].center - sphere.center) <= reach * reach)
            visit(place->second);
      }
  }

 private:
  std::array<int, 3> cube(Vec3 p) const {
    const auto index = [&](double x) { return static_cast<int>(std::floor(x / size_)); };
    return {index(p.x), index(p.y), index(p.z)};
  }
  std::array<int, 3> key(std::uint32_t piece) const { return cube(pieces_.around[piece].center); }

  const Pieces& pieces_;
  double size_;
  std::vector<std::pair<std::array<int, 3>, std::uint32_t>> places_;
};

// Groups whose spheres become smaller step by step.
class Shrinking {
 public:
  Shrinking(const Pieces& pieces, double size, std::vector<Group> groups)
      : pieces_(pieces), grid_(pieces, size), groups_(std::move(groups)) {}

  std::vector<Sphere> run(const std::function<void(double)>& progress) {
    std::vector<Sphere> best = spheres();
    for (int round = 0; round < kRounds; ++round) {
      for (int k = 0; k < kShrinksPerRound; ++k) shrink();
      if (const std::vector<Sphere> now = spheres(); total(now) < total(best)) best = now;
      if (progress) progress(static_cast<double>(round + 1) / kRounds);
      if (round + 1 < kRounds) reassign();
    }
    return best;
  }

 private:
  std::vector<Sphere> spheres() const {
    std::vector<Sphere> all;
    for (const Group& group : groups_) all.push_back(group.sphere);
    return all;
  }
  static double total(const std::vector<Sphere>& spheres) {
    double sum = 0;
    for (const Sphere& s : spheres) sum += volume(s);
    return sum;
  }

  std::vector<std::uint32_t> held_by(const Sphere& sphere) const {
    std::vector<std::uint32_t> held;
    grid_.near(sphere, [&](std::uint32_t piece) {
      if (pieces_.holds(sphere, piece)) held.push_back(piece);
    });
    return held;
  }

  // Lets each sphere, the largest first, hold only what no other one does. Spheres that are needed
  // for nothing then divide the group of another one.
  void shrink() {
    std::ranges::sort(
        groups_, [](const Group& a, const Group& b) { return largest_first(a.sphere, b.sphere); });
    std::vector<std::vector<std::uint32_t>> held(groups_.size());
    parallel_for(groups_.size(), 4, [&](std::size_t first, std::size_t last) {
      for (std::size_t k = first; k < last; ++k) held[k] = held_by(groups_[k].sphere);
    });
    std::vector<std::uint32_t> holders(pieces_.size(), 0);
    for (const auto& members : held)
      for (const std::uint32_t piece : members) ++holders[piece];
    std::vector<Group> needed;
    for (std::size_t k = 0; k < groups_.size(); ++k) {
      std::vector<std::uint32_t> own;
      for (const std::uint32_t piece : held[k])
        if (--holders[piece] == 0) own.push_back(piece);
      if (own.empty()) continue;
      std::ranges::sort(own);
      const Sphere sphere = sphere_about(pieces_, own);
      needed.push_back(group_in(pieces_, sphere, held_by(sphere)));
      for (const std::uint32_t piece : needed.back().members) ++holders[piece];
    }
    const std::size_t count = groups_.size();
    groups_ = std::move(needed);
    divide_until(pieces_, groups_, count);
  }

  // Gives every piece to the sphere that must grow least for it, of those that are near.
  void reassign() {
    constexpr double kReach = 1.3;
    std::vector<double> least(pieces_.size(), HUGE_VAL);
    std::vector<std::uint32_t> taker(pieces_.size(), 0);
    for (std::uint32_t k = 0; k < groups_.size(); ++k) {
      const Sphere& sphere = groups_[k].sphere;
      grid_.near({sphere.center, kReach * sphere.radius}, [&](std::uint32_t piece) {
        // Relative to the size: a small sphere grows more for the same piece.
        const double growth = pieces_.beyond(piece, sphere) / sphere.radius;
        if (growth < least[piece]) least[piece] = growth, taker[piece] = k;
      });
    }
    std::vector<std::vector<std::uint32_t>> members(groups_.size());
    for (std::uint32_t piece = 0; piece < pieces_.size(); ++piece)
      members[taker[piece]].push_back(piece);
    std::vector<Group> groups(groups_.size());
    parallel_for(groups.size(), 4, [&](std::size_t first, std::size_t last) {
      for (std::size_t k = first; k < last; ++k)
        if (!members[k].empty()) groups[k] = group_of(pieces_, std::move(members[k]));
    });
    std::erase_if(groups, [](const Group& group) { return group.members.empty(); });
    divide_until(pieces_, groups, groups_.size());
    groups_ = std::move(groups);
  }

  const Pieces& pieces_;
  PieceGrid grid_;
  std::vector<Group> groups_;
};

// Returns the size of pieces for so many spheres.
double piece_size(const SolidCells& cells, std::size_t count) {
  const double wanted = std::max(kFewestPieces, kPiecesPerSphere * static_cast<double>(count));
  const UnitFrame& frame = cells.distance().frame();
  return std::min(cells.box().longest(),
                  std::cbrt(cells.distance().volume() / wanted) / frame.scale);
}

}  // namespace

std::vector<Sphere> cover(const Solid& solid, std::size_t count, const Enclosure* enclosure,
                          const std::function<void(double)>& progress) {
  const SolidCells cells(solid, enclosure);
  if (!(cells.distance().volume() > 0)) refuse("the solid has no volume");
  double size = piece_size(cells, count);
  Pieces pieces = pieces_of(cells, size);
  while (pieces.size() < 2 * count) pieces = pieces_of(cells, size *= 0.75);
  std::vector<std::uint32_t> all(pieces.size());
  for (std::uint32_t k = 0; k < all.size(); ++k) all[k] = k;
  std::vector<Group> groups{group_of(pieces, std::move(all))};
  divide_until(pieces, groups, count);
  std::vector<Sphere> spheres = Shrinking(pieces, 2 * size, std::move(groups)).run(progress);
  const UnitFrame& frame = cells.distance().frame();
  constexpr double kRounding = 1e-12;  // relative; a few last digits
  for (Sphere& s : spheres)
    s = {frame.to_solid(s.center), (1 + kRounding) * s.radius * frame.scale + frame.rounding};
  std::ranges::sort(spheres, largest_first);
  return spheres;
}

}  // namespace vpm
