#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "libvpm/core/parallel.h"
#include "libvpm/graph/enclosing_sphere.h"
#include "libvpm/packing/outer_cover.h"
#include "libvpm/packing/solid_cells.h"

namespace vpm {
namespace {

// Cells are divided at first without asking what they hold, and never below this size, relative to
// the longest side.
constexpr int kFirstDivisions = 9;
constexpr double kSmallest = 0x1p-14;

class Proof {
 public:
  Proof(const Solid& solid, const std::vector<Sphere>& spheres, const Enclosure* enclosure)
      : cells_(solid, enclosure) {
    const UnitFrame& frame = cells_.distance().frame();
    for (const Sphere& s : spheres)
      spheres_.push_back({frame.to_unit(s.center), s.radius / frame.scale});
  }

  CoverCertificate run() const {
    std::vector<Cell> tasks{cells_.box()};
    for (int k = 0; k < kFirstDivisions; ++k) {
      std::vector<Cell> finer;
      for (const Cell& cell : tasks)
        for (const Cell& half : cell.halves()) finer.push_back(half);
      tasks = std::move(finer);
    }
    std::vector<CoverCertificate> parts(tasks.size());
    parallel_for(tasks.size(), 1, [&](std::size_t first, std::size_t last) {
      for (std::size_t k = first; k < last; ++k) {
        parts[k].holds = true;
        prove(tasks[k], SolidCells::Place::cut, spheres_, parts[k]);
      }
    });
    CoverCertificate whole;
    whole.holds = true;
    for (const CoverCertificate& part : parts) {
      whole.cells += part.cells;
      if (whole.holds && !part.holds) whole.holds = false, whole.open = part.open;
    }
    return whole;
  }

 private:
  // Divides the cell until the proof is there, or fails. Of the spheres only those that reach the
  // cell are given.
  void prove(const Cell& cell, SolidCells::Place place, std::span<const Sphere> near,
             CoverCertificate& proof) const {
    if (!proof.holds) return;
    std::vector<Sphere> reaching;
    for (const Sphere& s : near)
      if (reaches(s, cell)) reaching.push_back(s);
    if (place == SolidCells::Place::cut) place = cells_.place(cell);
    if (place == SolidCells::Place::outside || is_held(cell, place, reaching)) {
      ++proof.cells;
    } else if (reaching.empty() || cell.longest() < kSmallest) {
      proof.holds = false;
      proof.open = cells_.distance().frame().to_solid(cell.center());
    } else {
      for (const Cell& half : cell.halves()) prove(half, place, reaching, proof);
    }
  }

  // True if all that the cell has of the solid lies in one of the spheres.
  bool is_held(const Cell& cell, SolidCells::Place place, std::span<const Sphere> spheres) const {
    double largest = 0;
    for (const Sphere& s : spheres) {
      if (holds_corners(s, cell)) return true;
      largest = std::max(largest, s.radius);
    }
    // What a far larger cell has is in none, most likely, and takes long to find.
    if (place != SolidCells::Place::cut || (!spheres.empty() && cell.longest() > 2 * largest))
      return false;
    const std::vector<Sphere> hull = cells_.hull(cell, cells_.tolerance());
    return hull.empty() || std::ranges::any_of(spheres, [&](const Sphere& s) {
             return enclosing_radius(s.center, hull) <= s.radius;
           });
  }

  static bool reaches(const Sphere& s, const Cell& cell) {
    const Vec3 nearest{std::clamp(s.center.x, cell.low.x, cell.high.x),
                       std::clamp(s.center.y, cell.low.y, cell.high.y),
                       std::clamp(s.center.z, cell.low.z, cell.high.z)};
    return squared_norm(nearest - s.center) <= s.radius * s.radius;
  }

  bool holds_corners(const Sphere& s, const Cell& cell) const {
    const auto far = [](double c, double low, double high) { return std::max(c - low, high - c); };
    const Vec3 reach{far(s.center.x, cell.low.x, cell.high.x),
                     far(s.center.y, cell.low.y, cell.high.y),
                     far(s.center.z, cell.low.z, cell.high.z)};
    return norm(reach) + cells_.tolerance() <= s.radius;
  }

  SolidCells cells_;
  std::vector<Sphere> spheres_;
};

}  // namespace

CoverCertificate certify_cover(const Solid& solid, const std::vector<Sphere>& spheres,
                               const Enclosure* enclosure) {
  return Proof(solid, spheres, enclosure).run();
}

}  // namespace vpm
