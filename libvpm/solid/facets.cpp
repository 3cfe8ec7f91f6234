#include "libvpm/solid/facets.h"

#include <algorithm>
#include <map>
#include <queue>
#include <utility>

namespace vpm {
namespace {

using Edge = std::pair<std::uint32_t, std::uint32_t>;  // of vertices, the lower index first

Edge edge_of(std::uint32_t a, std::uint32_t b) {
  return a < b ? Edge{a, b} : Edge{b, a};
}

class Cutter {
 public:
  Cutter(const Solid& solid, double longest) : solid_(solid), longest_(longest) {
    for (std::uint32_t t = 0; t < solid_.triangles.size(); ++t)
      for (std::size_t k = 0; k < 3; ++k) {
        const Triangle& corners = solid_.triangles[t];
        const Edge edge = edge_of(corners[k], corners[(k + 1) % 3]);
        auto& list = triangles_[edge];
        if (list.empty()) add(edge);
        list.push_back(t);
      }
  }

  Solid run() {
    while (!pending_.empty()) {
      const Edge edge = pending_.top().second;
      pending_.pop();
      halve(edge);
    }
    return std::move(solid_);
  }

 private:
  void add(const Edge& edge) {
    const double length = norm(solid_.vertices[edge.first] - solid_.vertices[edge.second]);
    if (length > longest_) pending_.push({length, edge});
  }

  void halve(const Edge& edge) {
    const std::vector<std::uint32_t> list = std::move(triangles_.at(edge));
    triangles_.erase(edge);
    const auto middle = static_cast<std::uint32_t>(solid_.vertices.size());
    solid_.vertices.push_back(0.5 * (solid_.vertices[edge.first] + solid_.vertices[edge.second]));
    for (const std::uint32_t t : list) halve_triangle(t, edge, middle);
    add(edge_of(edge.first, middle));
    add(edge_of(edge.second, middle));
  }

  // Cuts triangle t from the middle of its edge to the corner opposite of it.
  void halve_triangle(std::uint32_t t, const Edge& edge, std::uint32_t middle) {
    Triangle& corners = solid_.triangles[t];
    std::size_t k = 0;
    while (edge_of(corners[k], corners[(k + 1) % 3]) != edge) ++k;
    const std::uint32_t from = corners[k], to = corners[(k + 1) % 3], apex = corners[(k + 2) % 3];
    const auto added = static_cast<std::uint32_t>(solid_.triangles.size());
    corners = {from, middle, apex};
    solid_.triangles.push_back({middle, to, apex});
    auto& beyond = triangles_[edge_of(to, apex)];
    std::replace(beyond.begin(), beyond.end(), t, added);
    triangles_[edge_of(from, middle)].push_back(t);
    triangles_[edge_of(to, middle)].push_back(added);
    triangles_[edge_of(middle, apex)] = {t, added};
    add(edge_of(middle, apex));
  }

  Solid solid_;
  double longest_;
  std::map<Edge, std::vector<std::uint32_t>> triangles_;
  std::priority_queue<std::pair<double, Edge>> pending_;  // longest first; ties by indices
};

}  // namespace

Solid cut_into_facets(const Solid& solid, double longest) {
  return Cutter(solid, longest).run();
}

}  // namespace vpm
