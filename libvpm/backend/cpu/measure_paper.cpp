#include "libvpm/backend/cpu/measure_paper.h"

#include <algorithm>

#include "libvpm/core/fixed_sum.h"

namespace vpm {

PaperMeasure::PaperMeasure(const ToolModel& tool, const Level& level) : tool_(tool), level_(level) {
  contacts_.resize(level.sphere_count);
  normals_.resize(level.sphere_count);
  depth_.resize(level.sphere_count);
  front_.reserve(level.sphere_count);
  next_front_.reserve(level.sphere_count);
}

// Adds the points strictly inside each sphere, and their caps (steps 1 and 2).
template <class Points>
std::uint32_t PaperMeasure::gather(const Points& points, const Pose& pose) {
  const Rotation to_tool = transpose(pose.rotation);
  const auto add = [&](std::uint32_t i, std::uint32_t point, Vec3 x) {
    const Sphere& s = tool_.spheres[i];
    const Vec3 n = to_tool * widen(points.normals()[point]);
    PaperContact::of_point(s, x, n).add_to(contacts_[i], add_atomically);
  };
  return for_points_inside(points, tool_, level_, pose, ranges_, add);
}

BodySum PaperMeasure::run(const AnyBody& body, const Pose& pose, std::vector<SphereState>& states) {
  std::fill(contacts_.begin(), contacts_.end(), PaperContact{});
  std::fill(states.begin(), states.end(), SphereState::outside);
  const std::uint32_t points =
      body.visit([&](const auto& one) { return gather(one.prepared(), pose); });
  find_boundary(states);
  enter(states);
  flood(states);
  BodySum result = total(states);
  result.points = points;
  return result;
}

// Marks spheres with a point in them as boundary, with the mean normal of their points (step 3).
void PaperMeasure::find_boundary(std::vector<SphereState>& states) {
  for (std::uint32_t i = 0; i < level_.sphere_count; ++i) {
    if (contacts_[i].points == 0) continue;
    states[i] = SphereState::boundary;
    normals_[i] = contacts_[i].mean_normal();
  }
}

// Enters neighbours with n_i . (c_j - c_i) <= -r_j (step 4). An entered sphere's normal is the mean
// over the boundary spheres that let it in.
void PaperMeasure::enter(std::vector<SphereState>& states) {
  const SphereGraph& graph = level_.graph;
  front_.clear();
  for (std::uint32_t j = 0; j < level_.sphere_count; ++j) {
    if (states[j] == SphereState::boundary) continue;
    Vec3 normal;
    bool entered = false;
    for (std::uint32_t k = graph.begin[j]; k < graph.begin[j + 1]; ++k) {
      const std::uint32_t i = graph.neighbors[k];
      if (states[i] != SphereState::boundary) continue;
      if (!lets_in(tool_.spheres[i], normals_[i], tool_.spheres[j])) continue;
      entered = true;
      normal += normals_[i];
    }
    if (!entered) continue;
    normals_[j] = normalized_or_zero(normal);
    depth_[j] = 1;
    front_.push_back(j);
  }
  for (const std::uint32_t j : front_) states[j] = SphereState::inside;
}

// Floods front by front (step 5): a sphere's normal is the mean over its neighbours in the front
// before, so it does not depend on the order of traversal.
void PaperMeasure::flood(std::vector<SphereState>& states) {
  const SphereGraph& graph = level_.graph;
  for (std::uint32_t depth = 2; !front_.empty(); ++depth) {
    next_front_.clear();
    for (const std::uint32_t i : front_) {
      for (std::uint32_t k = graph.begin[i]; k < graph.begin[i + 1]; ++k) {
        const std::uint32_t j = graph.neighbors[k];
        if (states[j] != SphereState::outside) continue;
        states[j] = SphereState::inside;
        depth_[j] = depth;
        next_front_.push_back(j);
      }
    }
    for (const std::uint32_t j : next_front_) {
      Vec3 normal;
      for (std::uint32_t k = graph.begin[j]; k < graph.begin[j + 1]; ++k) {
        const std::uint32_t i = graph.neighbors[k];
        if (states[i] == SphereState::inside && depth_[i] + 1 == depth) normal += normals_[i];
      }
      normals_[j] = normalized_or_zero(normal);
    }
    std::swap(front_, next_front_);
  }
}

// Sums the spheres (step 6).
BodySum PaperMeasure::total(const std::vector<SphereState>& states) const {
  const ToolMeasures measures = measures_of(tool_);
  BodySum result;
  for (std::uint32_t i = 0; i < level_.sphere_count; ++i) {
    if (states[i] == SphereState::boundary) {
      add_boundary(measures, tool_.spheres[i], contacts_[i], normals_[i], result.sum);
      ++result.boundary;
    } else if (states[i] == SphereState::inside) {
      add_inside(measures, tool_.spheres[i], normals_[i], result.sum);
      ++result.inside;
    }
  }
  return result;
}

}  // namespace vpm
