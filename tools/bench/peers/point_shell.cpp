#include "tools/bench/peers/point_shell.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <map>

#include "libvpm/core/pose.h"

namespace vpm::bench {
namespace {

constexpr std::uint32_t kLeaf = 8;    // most points of a node without children
constexpr std::uint32_t kMost = 4;    // children of a node
constexpr float kRounding = 1.0001F;  // by which spheres of floats are larger

// Says which axis a vector follows most, and which way: 0 to 5.
std::int64_t facing(Vec3 v) {
  const double x = std::abs(v.x), y = std::abs(v.y), z = std::abs(v.z);
  if (x >= y && x >= z) return v.x < 0 ? 0 : 1;
  if (y >= z) return v.y < 0 ? 2 : 3;
  return v.z < 0 ? 4 : 5;
}

// Calls visit(a, b, c) for pieces of a triangle whose edges are at most `spacing` long.
template <class Visit>
void cut_triangle(Vec3 a, Vec3 b, Vec3 c, double spacing, const Visit& visit) {
  const double ab = norm(b - a), bc = norm(c - b), ca = norm(a - c);
  const double longest = std::max({ab, bc, ca});
  if (longest <= spacing) return visit(a, b, c);
  if (ab < longest && bc == longest) return cut_triangle(b, c, a, spacing, visit);
  if (ab < longest) return cut_triangle(c, a, b, spacing, visit);
  const Vec3 middle = 0.5 * (a + b);
  cut_triangle(a, middle, c, spacing, visit);
  cut_triangle(middle, b, c, spacing, visit);
}

float distance_between(Vec3f a, Vec3f b) {
  return static_cast<float>(norm(widen(a) - widen(b)));
}

}  // namespace

PointShell::PointShell(const Solid& solid, double spacing)
    : center_(mass_properties(solid).center_of_mass) {
  struct Joined {
    Vec3 moment, area;
    double total = 0;
  };
  std::map<std::array<std::int64_t, 4>, Joined> joined;
  const auto add = [&](Vec3 a, Vec3 b, Vec3 c) {
    const Vec3 middle = (a + b + c) / 3, area = 0.5 * cross(b - a, c - a);
    const auto voxel = [&](double x) { return std::llround(x / spacing); };
    Joined& to = joined[{voxel(middle.x), voxel(middle.y), voxel(middle.z), facing(area)}];
    to.moment += norm(area) * middle, to.area += area, to.total += norm(area);
  };
  constexpr double kPieces = 2;  // along an edge of a voxel
  for (const Triangle& t : solid.triangles)
    cut_triangle(solid.vertices[t[0]] - center_, solid.vertices[t[1]] - center_,
                 solid.vertices[t[2]] - center_, spacing / kPieces, add);
  for (const auto& [voxel, of] : joined)
    points_.push_back({narrow(of.moment / of.total), narrow(of.area)});
  nodes_.push_back(node_of(0, static_cast<std::uint32_t>(points_.size())));
  for (std::size_t n = 0; n < nodes_.size(); ++n) {
    const auto [begin, end] = std::pair(nodes_[n].begin, nodes_[n].end);
    if (end - begin <= kLeaf) continue;
    const std::uint32_t middle = halve(begin, end);
    const std::uint32_t border[] = {begin, halve(begin, middle), middle, halve(middle, end), end};
    nodes_[n].child = static_cast<std::uint32_t>(nodes_.size());
    nodes_[n].children = kMost;
    for (std::size_t k = 0; k < kMost; ++k) nodes_.push_back(node_of(border[k], border[k + 1]));
  }
}

// Parts points by the middle one along the longest axis of their box.
std::uint32_t PointShell::halve(std::uint32_t begin, std::uint32_t end) {
  Box box;
  for (std::uint32_t p = begin; p < end; ++p) box.add(widen(points_[p].place));
  const int axis = box.longest_axis();
  const std::uint32_t middle = begin + (end - begin) / 2;
  std::nth_element(points_.begin() + begin, points_.begin() + middle, points_.begin() + end,
                   [&](const Point& a, const Point& b) {
                     return coordinate(widen(a.place), axis) < coordinate(widen(b.place), axis);
                   });
  return middle;
}

PointShell::Node PointShell::node_of(std::uint32_t begin, std::uint32_t end) const {
  Node node;
  node.begin = begin, node.end = end;
  Box box;
  Vec3 moment, area;
  double total = 0;
  for (std::uint32_t p = begin; p < end; ++p) {
    const Vec3 place = widen(points_[p].place), along = widen(points_[p].area);
    box.add(place);
    moment += norm(along) * place, total += norm(along), area += along;
  }
  node.center = narrow(0.5 * (box.low + box.high));
  for (std::uint32_t p = begin; p < end; ++p)
    node.radius = std::max(node.radius, distance_between(node.center, points_[p].place));
  node.radius *= kRounding;
  node.mean = {narrow(moment / total), narrow(area)};
  return node;
}

std::size_t PointShell::bytes(bool with_tree) const {
  return points_.size() * sizeof(Point) + (with_tree ? nodes_.size() * sizeof(Node) : 0);
}

// Sums in the tool's axes about its centre of mass.
struct ShellPeer::Sum {
  const DistanceField& field;
  DistanceField::ToVoxels to_voxels;
  Vec3f row[3];  // of the tool's rotation
  Vec3f force{}, torque{};
  float volume = 0;
  std::size_t contacts = 0;

  void add(const PointShell::Point& p) {
    const Vec3f at = to_voxels(p.place);
    if (!(field.distance(at) < 0)) return;
    const auto [s, g] = field.sample(at);
    const Vec3f &a = p.area, f{s * a.x, s * a.y, s * a.z};
    force = {force.x + f.x, force.y + f.y, force.z + f.z};
    torque = {torque.x + (p.place.y * f.z - p.place.z * f.y),
              torque.y + (p.place.z * f.x - p.place.x * f.z),
              torque.z + (p.place.x * f.y - p.place.y * f.x)};
    const auto along = [&](const Vec3f& r) { return r.x * f.x + r.y * f.y + r.z * f.z; };
    volume += g.x * along(row[0]) + g.y * along(row[1]) + g.z * along(row[2]);
    ++contacts;
  }
  void add(const PointShell& shell, const PointShell::Node& node) {
    for (std::uint32_t p = node.begin; p < node.end; ++p) add(shell.points()[p]);
  }
  // Says whether a point below the node may be inside. Between samples a field differs from the
  // true distance by less than a voxel.
  bool reaches(const PointShell::Node& node) const {
    return field.distance(to_voxels(node.center)) < node.radius + field.voxel();
  }
};

PeerAnswer ShellPeer::query(const Pose& pose) {
  const Pose about{pose.rotation, pose * shell_->center()};
  const Rotation& r = pose.rotation;
  Sum sum{*field_, field_->to_voxels(about), {narrow(r.row0), narrow(r.row1), narrow(r.row2)}};
  if (walk_ == ShellWalk::flat) {
    for (const PointShell::Point& p : shell_->points()) sum.add(p);
  } else if (walk_ == ShellWalk::tree) {
    walk_tree(sum);
  } else {
    walk_levels(sum);
  }
  return {sum.volume, {r * widen(sum.force), r * widen(sum.torque)}, sum.contacts};
}

void ShellPeer::walk_tree(Sum& sum) {
  open_.assign(1, 0);
  while (!open_.empty()) {
    const PointShell::Node& node = shell_->nodes()[open_.back()];
    open_.pop_back();
    if (!sum.reaches(node)) continue;
    if (node.children == 0) sum.add(*shell_, node);
    for (std::uint32_t k = 0; k < node.children; ++k) open_.push_back(node.child + k);
  }
}

// Goes down level by level while the next one will be done in time, at the cost of a node so far,
// and the sum after it; then the nodes met last stand for their points.
void ShellPeer::walk_levels(Sum& sum) {
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  const auto seconds = [&] { return std::chrono::duration<double>(Clock::now() - start).count(); };
  open_.assign(1, 0);
  std::size_t met = 1;  // nodes
  const auto is_leaf = [&](std::uint32_t n) { return shell_->nodes()[n].children == 0; };
  for (bool goes_on = true; goes_on;) {
    next_.clear();
    goes_on = false;
    for (const std::uint32_t n : open_) {
      const PointShell::Node& node = shell_->nodes()[n];
      if (!sum.reaches(node)) continue;
      if (node.children == 0) next_.push_back(n);
      for (std::uint32_t k = 0; k < node.children; ++k)
        next_.push_back(node.child + k), goes_on = true;
    }
    open_.swap(next_);
    const double now = seconds(), of_node = now / static_cast<double>(met),
                 sums = !open_.empty() && is_leaf(open_[0]) ? kLeaf : 1;
    if (now + (1 + sums) * of_node * static_cast<double>(open_.size()) > deadline_) break;
    met += open_.size();
  }
  for (const std::uint32_t n : open_) {
    const PointShell::Node& node = shell_->nodes()[n];
    if (node.children == 0)
      sum.add(*shell_, node);
    else
      sum.add(node.mean);
  }
}

PeerAnswer VoxelCountPeer::query(const Pose& pose) {
  const DistanceField::ToVoxels to_voxels = scene_->to_voxels(pose);
  std::size_t count = 0;
  for (const Vec3f& place : places_) count += scene_->distance(to_voxels(place)) < 0;
  PeerAnswer answer;
  answer.volume = voxel_ * voxel_ * voxel_ * static_cast<double>(count);
  return answer;
}

}  // namespace vpm::bench
