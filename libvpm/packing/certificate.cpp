#include "libvpm/packing/certificate.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "libvpm/core/error.h"
#include "libvpm/core/parallel.h"
#include "libvpm/mesh/triangle_bvh.h"
#include "libvpm/mesh/winding_number.h"

namespace vpm {
namespace {

constexpr std::size_t kSpheresPerTask = 64, kColumnsPerTask = 4;

double largest(const std::vector<double>& values, double at_least) {
  return values.empty() ? at_least
                        : std::max(at_least, *std::max_element(values.begin(), values.end()));
}

// Returns the largest radius minus signed distance to the surface.
double protrusion(const Solid& solid, const std::vector<Sphere>& spheres,
                  const Enclosure* enclosure) {
  const TriangleBvh mesh(solid.vertices, solid.triangles);
  const WindingNumber winding(mesh);
  std::optional<Enclosure> found;
  if (enclosure == nullptr) enclosure = &found.emplace(enclosure_of(solid));
  std::optional<TriangleBvh> pieces;
  if (enclosure->surface)
    pieces.emplace(enclosure->surface->vertices, enclosure->surface->triangles);
  const TriangleBvh& surface = pieces ? *pieces : mesh;
  std::vector<double> beyond(spheres.size());
  parallel_for(spheres.size(), kSpheresPerTask, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Sphere& s = spheres[i];
      const double distance = surface.closest(s.center).distance;
      beyond[i] = s.radius + (winding.inside(s.center) ? -distance : distance);
    }
  });
  return largest(beyond, -HUGE_VAL);
}

// Columns along x over a grid in y and z; each sphere is listed in all columns that it comes near.
class Columns {
 public:
  Columns(const std::vector<Sphere>& spheres, double margin) : margin_(margin) {
    low_ = HUGE_VAL;
    double high = -HUGE_VAL;
    for (const Sphere& s : spheres) {
      low_ = std::min({low_, s.center.y - s.radius, s.center.z - s.radius});
      high = std::max({high, s.center.y + s.radius, s.center.z + s.radius});
    }
    // Makes a few dozen spheres per column, whatever their sizes.
    count_ = std::clamp(std::size_t(std::sqrt(double(spheres.size()) / 32)), std::size_t{1},
                        std::size_t{1000});
    width_ = (high - low_) / static_cast<double>(count_);
    lists_.resize(count_ * count_);
    for (const Sphere& s : spheres) {
      for (std::size_t z = of(s.center.z - s.radius - margin);
           z <= of(s.center.z + s.radius + margin); ++z)
        for (std::size_t y = of(s.center.y - s.radius - margin);
             y <= of(s.center.y + s.radius + margin); ++y)
          lists_[z * count_ + y].push_back(s);
    }
  }
  std::size_t size() const { return lists_.size(); }

  // Returns the largest overlap of two spheres of the column, at least -margin, by a sweep along x.
  double overlap(std::size_t column) {
    std::vector<Sphere>& list = lists_[column];
    std::sort(list.begin(), list.end(), [](const Sphere& a, const Sphere& b) {
      return a.center.x - a.radius < b.center.x - b.radius;
    });
    double worst = -margin_;
    for (std::size_t i = 0; i < list.size(); ++i) {
      const Sphere& s = list[i];
      for (std::size_t j = i + 1; j < list.size(); ++j) {
        const Sphere& t = list[j];
        if (t.center.x - t.radius > s.center.x + s.radius + margin_) break;
        worst = std::max(worst, s.radius + t.radius - norm(s.center - t.center));
      }
    }
    return worst;
  }

 private:
  std::size_t of(double coordinate) const {
    const double column = (coordinate - low_) / width_;
    return static_cast<std::size_t>(std::clamp(column, 0.0, static_cast<double>(count_ - 1)));
  }
  double margin_, low_ = 0, width_ = 0;
  std::size_t count_ = 1;
  std::vector<std::vector<Sphere>> lists_;
};

double overlap(const std::vector<Sphere>& spheres, double margin) {
  if (spheres.size() < 2) return -margin;
  Columns columns(spheres, margin);
  std::vector<double> worst(columns.size());
  parallel_for(columns.size(), kColumnsPerTask, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) worst[i] = columns.overlap(i);
  });
  return largest(worst, -margin);
}

}  // namespace

Certificate certify(const Solid& solid, const std::vector<Sphere>& spheres,
                    const Enclosure* enclosure) {
  double farthest = 0;
  const Vec3 first = solid.vertices.empty() ? Vec3{} : solid.vertices.front();
  Vec3 low = first, high = first;
  for (const Vec3 p : solid.vertices) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    farthest = std::max({farthest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  }
  const double extent = std::max({high.x - low.x, high.y - low.y, high.z - low.z});
  Certificate certificate;
  certificate.tolerance = std::max(kCertificateTolerance * extent,
                                   16 * std::numeric_limits<double>::epsilon() * farthest);
  const auto sound = [](const Sphere& s) {
    return is_finite(s.center) && std::isfinite(s.radius) && s.radius > 0;
  };
  if (!std::all_of(spheres.begin(), spheres.end(), sound)) {
    certificate.max_protrusion = certificate.max_overlap = HUGE_VAL;
    return certificate;
  }
  const double margin = certificate.tolerance;
  certificate.max_protrusion = std::max(protrusion(solid, spheres, enclosure), -margin);
  certificate.max_overlap = overlap(spheres, margin);
  certificate.holds = certificate.max_protrusion <= certificate.tolerance &&
                      certificate.max_overlap <= certificate.tolerance;
  return certificate;
}

void refuse_uncertified(const std::string& name, double coverage, const Certificate& certificate) {
  if (coverage > 1 + kCertificateTolerance)
    refuse("the spheres hold " + std::to_string(coverage) +
               " times the volume of the mesh, which intersects itself so that its inside is "
               "ambiguous; nothing is written.",
           name, "Give `repair` voxel");
  if (certificate.holds) return;
  refuse("the packing does not hold its certificate (protrusion " +
             std::to_string(certificate.max_protrusion) + " m, overlap " +
             std::to_string(certificate.max_overlap) + " m); nothing is written.",
         name, "This is a bug of `pack`: please report it with the mesh");
}

}  // namespace vpm
