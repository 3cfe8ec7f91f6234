#include "libvpm/mesh/shells.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "libvpm/core/solid_angle.h"
#include "libvpm/mesh/ray_crossings.h"

namespace vpm {
namespace {

// Number of vertices that decide if a shell lies within another one.
constexpr std::size_t kSamples = 16;
// Deviation from an integer winding number above which a point lies on the shell.
constexpr double kOnSurface = 0.1;
// Deviation from half the full solid angle below which a triangle has the point in its plane.
constexpr double kFlat = 1e-9;

struct Shell {
  std::vector<std::uint32_t> triangles;
  Vec3 low, high;
  std::vector<Vec3> samples;  // some of its vertices; none if it is the only shell
  double volume = 0;          // signed
};

// Returns some vertices, spread over the list of triangles.
std::vector<Vec3> samples_of(const std::vector<Vec3>& vertices,
                             const std::vector<Triangle>& triangles,
                             const std::vector<std::uint32_t>& shell) {
  std::vector<std::uint32_t> used;
  for (const std::uint32_t t : shell)
    used.insert(used.end(), triangles[t].begin(), triangles[t].end());
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  std::vector<Vec3> samples;
  const std::size_t count = std::min(used.size(), kSamples);
  for (std::size_t k = 0; k < count; ++k)
    samples.push_back(vertices[used[k * used.size() / count]]);
  return samples;
}

std::vector<Shell> collect(const std::vector<Vec3>& vertices,
                           const std::vector<std::uint32_t>& shell_of_triangle, std::size_t count,
                           const std::vector<Triangle>& triangles) {
  std::vector<Shell> shells(count);
  for (std::uint32_t t = 0; t < triangles.size(); ++t)
    shells[shell_of_triangle[t]].triangles.push_back(t);
  for (Shell& shell : shells) {
    shell.low = shell.high = vertices[triangles[shell.triangles.front()][0]];
    if (count > 1) shell.samples = samples_of(vertices, triangles, shell.triangles);
    for (const std::uint32_t t : shell.triangles) {
      for (const std::uint32_t corner : triangles[t]) {
        const Vec3 p = vertices[corner];
        shell.low = {std::min(shell.low.x, p.x), std::min(shell.low.y, p.y),
                     std::min(shell.low.z, p.z)};
        shell.high = {std::max(shell.high.x, p.x), std::max(shell.high.y, p.y),
                      std::max(shell.high.z, p.z)};
      }
    }
    const Vec3 origin = shell.low + 0.5 * (shell.high - shell.low);
    for (const std::uint32_t t : shell.triangles) {
      const Vec3 a = vertices[triangles[t][0]] - origin, b = vertices[triangles[t][1]] - origin,
                 c = vertices[triangles[t][2]] - origin;
      shell.volume += dot(a, cross(b, c)) / 6;
    }
  }
  return shells;
}

// Returns the winding number of the shell about p, from the solid angles of its triangles, exact;
// none if p lies on the shell.
std::optional<double> winding_number(const std::vector<Vec3>& vertices,
                                     const std::vector<Triangle>& triangles, const Shell& shell,
                                     Vec3 p) {
  double angle = 0;
  for (const std::uint32_t t : shell.triangles) {
    const Vec3 a = vertices[triangles[t][0]] - p, b = vertices[triangles[t][1]] - p,
               c = vertices[triangles[t][2]] - p;
    const double of_triangle = TriangleAngle(a, b, c).value();
    if (std::abs(of_triangle) > (1 - kFlat) * (kFullSolidAngle / 2)) return std::nullopt;
    angle += of_triangle;
  }
  const double number = angle / kFullSolidAngle;
  if (std::abs(number - std::round(number)) > kOnSurface) return std::nullopt;
  return number;
}

bool box_holds(const Shell& shell, Vec3 p) {
  return p.x >= shell.low.x && p.x <= shell.high.x && p.y >= shell.low.y && p.y <= shell.high.y &&
         p.z >= shell.low.z && p.z <= shell.high.z;
}

enum class Enclosure { none, half, whole };

// Finds the shells around each shell, by rays from some of its vertices.
class EnclosureSearch {
 public:
  EnclosureSearch(const std::vector<Vec3>& vertices,
                  const std::vector<std::uint32_t>& shell_of_triangle,
                  const std::vector<Triangle>& triangles, const std::vector<Shell>& shells)
      : vertices_(vertices),
        shell_of_(shell_of_triangle),
        triangles_(triangles),
        shells_(shells),
        rays_(vertices, triangles) {}

  // Returns for each shell, in ascending order, the shells that enclose at least `least` of it.
  std::vector<std::vector<std::uint32_t>> all(Enclosure least, const MeshProgress& progress) const {
    std::vector<std::vector<std::uint32_t>> enclosing(shells_.size());
    std::vector<std::uint64_t> work(shells_.size(), 0);
    WorkLimit limit(triangles_.size());
    const auto work_of = [&](std::size_t k) {
      return work[k] = find(static_cast<std::uint32_t>(k), least, enclosing[k]);
    };
    if (!run_within(limit, shells_.size(), work_of, progress)) {
      const auto worst = std::max_element(work.begin(), work.end()) - work.begin();
      throw TooMuchWork(
          "its " + std::to_string(shells_.size()) +
              " shells (connected surfaces) lie around or on one another in too many places",
          shells_[static_cast<std::size_t>(worst)].samples.front(),
          "delete doubled or inner parts, or pack the parts one by one");
    }
    return enclosing;
  }

 private:
  // Counts of what the samples of one shell, and the ray from one sample, meet of another shell.
  struct Tally {
    std::uint32_t inside = 0, undecided = 0;  // samples
    int enclosures = 0;                       // enclosures of the present sample
    bool doubtful = false, passed = false, listed = false;
  };
  // Kept from shell to shell, so that each costs only what its rays pass.
  struct Scratch {
    std::vector<Tally> tally;  // all zero between calls
    std::vector<std::uint32_t> passed, listed;
  };

  // Ignores vertices on the other shell's surface, since parts may touch.
  std::uint64_t find(std::uint32_t k, Enclosure least, std::vector<std::uint32_t>& found) const {
    static thread_local Scratch scratch;
    if (scratch.tally.size() < shells_.size()) scratch.tally.resize(shells_.size());
    std::uint64_t work = 0;
    for (const Vec3 p : shells_[k].samples) work += add_sample(p, k, scratch);
    std::sort(scratch.listed.begin(), scratch.listed.end());
    for (const std::uint32_t other : scratch.listed) {
      if (enclosure(scratch.tally[other], shells_[k].samples.size()) >= least)
        found.push_back(other);
      scratch.tally[other] = {};
    }
    scratch.listed.clear();
    return work;
  }

  static Enclosure enclosure(const Tally& tally, std::size_t samples) {
    const std::size_t outside = samples - tally.inside - tally.undecided;
    if (tally.inside == 0 || outside > tally.inside || 2 * outside > samples)
      return Enclosure::none;
    return outside == 0 ? Enclosure::whole : Enclosure::half;
  }

  // Adds what a sample of shell `own` says of the shells that its ray passes. Returns the work.
  std::uint64_t add_sample(Vec3 p, std::uint32_t own, Scratch& scratch) const {
    std::vector<Tally>& tally = scratch.tally;
    std::uint64_t work = rays_.from(p, [&](std::uint32_t t, Crossing crossing) {
      Tally& other = tally[shell_of_[t]];
      if (!other.passed && shell_of_[t] != own) {
        other.passed = true;
        scratch.passed.push_back(shell_of_[t]);
      }
      other.doubtful = other.doubtful || crossing == Crossing::doubtful;
      other.enclosures += crossing == Crossing::outward ? 1 : -1;
    });
    tally[own] = {};
    for (const std::uint32_t index : scratch.passed) {
      Tally& other = tally[index];
      std::optional<double> number = other.enclosures;
      if (!box_holds(shells_[index], p)) {
        number = 0;
      } else if (other.doubtful) {
        number = winding_number(vertices_, triangles_, shells_[index], p);
        work += work::kSolidAngle * shells_[index].triangles.size();
      }
      if (!other.listed && (!number || std::abs(*number) > 0.5)) {
        other.listed = true;
        scratch.listed.push_back(index);
      }
      if (!number) ++other.undecided;
      if (number && std::abs(*number) > 0.5) ++other.inside;
      other.enclosures = 0;
      other.doubtful = other.passed = false;
    }
    scratch.passed.clear();
    return work;
  }

  const std::vector<Vec3>& vertices_;
  const std::vector<std::uint32_t>& shell_of_;
  const std::vector<Triangle>& triangles_;
  const std::vector<Shell>& shells_;
  RayCrossings rays_;
};

std::vector<std::vector<std::uint32_t>> find_enclosing(
    const std::vector<Vec3>& vertices, const std::vector<std::uint32_t>& shell_of_triangle,
    const std::vector<Triangle>& triangles, const std::vector<Shell>& shells, Enclosure least,
    const MeshProgress& progress) {
  if (shells.size() < 2) return std::vector<std::vector<std::uint32_t>>(shells.size());
  return EnclosureSearch(vertices, shell_of_triangle, triangles, shells).all(least, progress);
}

}  // namespace

std::vector<ShellPlace> place_shells(const std::vector<Vec3>& vertices,
                                     const std::vector<std::uint32_t>& shell_of_triangle,
                                     std::size_t shell_count,
                                     const std::vector<Triangle>& triangles) {
  const std::vector<Shell> shells = collect(vertices, shell_of_triangle, shell_count, triangles);
  const auto enclosing =
      find_enclosing(vertices, shell_of_triangle, triangles, shells, Enclosure::half, {});
  std::vector<ShellPlace> places;
  for (std::size_t k = 0; k < shells.size(); ++k)
    places.push_back({enclosing[k].size(), shells[k].volume >= 0});
  return places;
}

ShellOrientation orient_shells(const std::vector<Vec3>& vertices,
                               const std::vector<std::uint32_t>& shell_of_triangle,
                               std::size_t shell_count, bool given_consistent,
                               std::vector<Triangle>& triangles, const MeshProgress& progress) {
  std::vector<Shell> shells = collect(vertices, shell_of_triangle, shell_count, triangles);
  // Without consistent orientation, a shell that crosses another is a body.
  const auto enclosing =
      find_enclosing(vertices, shell_of_triangle, triangles, shells,
                     given_consistent ? Enclosure::half : Enclosure::whole, progress);
  // Nested shells turn with the outermost one.
  const auto faces_wrong = [&](std::size_t k) {
    if (given_consistent) {
      const auto outermost = [&](std::uint32_t other) { return enclosing[other].empty(); };
      const auto root = std::find_if(enclosing[k].begin(), enclosing[k].end(), outermost);
      return (root == enclosing[k].end() ? shells[k] : shells[*root]).volume < 0;
    }
    const bool is_cavity = enclosing[k].size() % 2 == 1;
    return is_cavity ? shells[k].volume > 0 : shells[k].volume < 0;
  };
  ShellOrientation done;
  for (std::size_t k = 0; k < shells.size(); ++k) {
    const bool wrong = faces_wrong(k), nested = !enclosing[k].empty();
    if (wrong) {
      ++done.turned;
      for (const std::uint32_t t : shells[k].triangles) std::swap(triangles[t][1], triangles[t][2]);
    }
    const bool outward = (shells[k].volume < 0) == wrong;
    done.cavities += nested && !outward;
  }
  return done;
}

}  // namespace vpm
