#include "tools/pack/pack_view.h"

#include <algorithm>

#include "libvpm/core/parallel.h"
#include "libvpm/mesh/mesh_defects.h"
#include "libvpm/packing/solid_distance.h"
#include "libvpm/view/page.h"

namespace vpm::tools {
namespace {

constexpr const char* kSolidColor = "#b08d57";
// Defects in colours that the colour-blind can tell apart, too.
constexpr const char *kHoleColor = "#d55e00", *kNonManifoldColor = "#0072b2",
                     *kConflictColor = "#cc79a7", *kCrossingColor = "#c80000",
                     *kUncoveredColor = "#cc3fa0";
constexpr std::size_t kMostCrossing = 20'000;
// Places that are asked whether a sphere covers them, and the distances that this may take.
constexpr std::size_t kMostPlaces = 40'000, kFewestPlaces = 4'000, kMostDistances = 200'000'000;

std::vector<Vec3> ends_of(const std::vector<Segment>& segments) {
  std::vector<Vec3> ends;
  for (const Segment& s : segments) ends.insert(ends.end(), s.begin(), s.end());
  return ends;
}

void add_defects(view::Page& page, const MeshDefects& defects) {
  const auto add = [&](const char* name, const char* color, std::vector<Vec3> ends,
                       std::size_t count) {
    if (count > 0)
      page.add_lines({.name = name,
                      .color = color,
                      .ends = std::move(ends),
                      .count = count,
                      .marks = true,
                      .above = true});
  };
  // Adds these first: edges of the other defects may lie on them, and are drawn over them.
  std::vector<Vec3> crossing;
  for (std::size_t k = 0; k < std::min(defects.crossing.size(), kMostCrossing); ++k) {
    const auto& [a, b, c] = defects.crossing[k];
    crossing.insert(crossing.end(), {a, b, b, c, c, a});
  }
  add("triangles that cut others", kCrossingColor, std::move(crossing), defects.crossing.size());
  std::vector<Vec3> rims;
  for (const std::vector<Segment>& rim : defects.holes) {
    const std::vector<Vec3> ends = ends_of(rim);
    rims.insert(rims.end(), ends.begin(), ends.end());
  }
  add("holes", kHoleColor, std::move(rims), defects.holes.size());
  add("non-manifold edges", kNonManifoldColor, ends_of(defects.non_manifold),
      defects.non_manifold.size());
  add("neighbours that face opposite ways", kConflictColor, ends_of(defects.conflicting),
      defects.conflicting.size());
  std::vector<Vec3> touching;
  for (const Vec3& p : defects.pinched) touching.insert(touching.end(), {p, p});
  add("vertices where the surface touches itself", kNonManifoldColor, std::move(touching),
      defects.pinched.size());
}

// Returns the k-th number of the van der Corput sequence: evenly spread over 0 .. 1.
double spread(std::size_t k, std::size_t base) {
  double value = 0, digit = 1;
  for (; k > 0; k /= base) {
    digit /= static_cast<double>(base);
    value += digit * static_cast<double>(k % base);
  }
  return value;
}

struct Uncovered {
  std::vector<Vec3> places;
  std::vector<std::uint32_t> until;  // the first sphere that covers the place, or their number
};

// Asks places spread evenly over the solid's box.
Uncovered find_uncovered(const CheckedSolid& checked, const std::vector<Sphere>& spheres) {
  const SolidDistance distance(checked.solid, &checked.enclosure);
  const std::size_t count = std::clamp(kMostDistances / spheres.size(), kFewestPlaces, kMostPlaces);
  const Vec3 low = checked.facts.low, size = checked.facts.high - checked.facts.low;
  std::vector<Vec3> places(count);
  std::vector<std::uint32_t> until(count, 0);
  parallel_for(count, 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const Vec3 p = low + Vec3{size.x * spread(k + 1, 2), size.y * spread(k + 1, 3),
                                size.z * spread(k + 1, 5)};
      if (!distance.inside(distance.frame().to_unit(p))) continue;
      const auto covers = [&](const Sphere& s) {
        return squared_norm(p - s.center) < s.radius * s.radius;
      };
      places[k] = p;
      until[k] =
          static_cast<std::uint32_t>(std::ranges::find_if(spheres, covers) - spheres.begin());
    }
  });
  Uncovered uncovered;
  for (std::size_t k = 0; k < count; ++k) {
    if (until[k] == 0) continue;  // outside of the solid, or in the first sphere
    uncovered.places.push_back(places[k]);
    uncovered.until.push_back(until[k]);
  }
  return uncovered;
}

void add_coverage(view::Page& page, const std::vector<Sphere>& spheres, double solid_volume) {
  view::Column covered{"covered", "%", 1, {}}, radius{"radius of the last", "m", 1, {}};
  double volume_so_far = 0;
  for (const Sphere& s : spheres) {
    volume_so_far += volume(s);
    covered.values.push_back(static_cast<float>(100 * volume_so_far / solid_volume));
    radius.values.push_back(static_cast<float>(s.radius));
  }
  const std::size_t column = page.add_column(covered);
  page.add_column(radius);
  if (spheres.size() > 1)
    page.add_chart({{"type", "curve"},
                    {"title", "Coverage"},
                    {"x", "spheres"},
                    {"y", "covered"},
                    {"first", 1},
                    {"columns", {column}},
                    {"names", {"covered"}}});
}

}  // namespace

void write_defects_view(const std::string& path, const RawMesh& mesh, const SolidOptions& options,
                        const std::string& why, const std::string& cure) {
  const Solid triangles = triangles_of(mesh, options);
  if (triangles.triangles.empty()) return;
  view::Page page("vpm-pack", view::shown_name(mesh.name) + ": refused");
  page.set_origin(triangles.vertices.front());
  if (!cure.empty()) page.add_note(cure);  // first: a list of defects is longer than the box
  page.add_note(why);
  page.add_fact("vertices", std::to_string(triangles.vertices.size()));
  page.add_fact("triangles", std::to_string(triangles.triangles.size()));
  page.add_mesh({.name = "mesh", .color = kSolidColor, .solid = &triangles, .opacity = 0.45});
  add_defects(page, find_defects(triangles));
  page.set_views({"overview", "side"});
  page.write(path);
}

void write_packing_view(const std::string& path, const std::string& mesh,
                        const CheckedSolid& checked, const PackResult& packed) {
  const std::vector<Sphere>& spheres = packed.spheres;
  view::Page page("vpm-pack",
                  std::to_string(spheres.size()) + " spheres in " + view::shown_name(mesh));
  page.set_origin(0.5 * (checked.facts.low + checked.facts.high));
  for (const std::string& warning : checked.warnings) page.add_note(warning);
  page.add_fact("mesh", view::shown_name(mesh));
  page.add_fact("triangles", std::to_string(checked.facts.triangles));
  page.add_fact("volume", view::volume_text(checked.facts.volume));
  page.add_mesh({.name = "solid", .color = kSolidColor, .solid = &checked.solid, .opacity = 0.25});
  page.add_spheres({.name = "spheres by radius", .spheres = spheres, .prefix = true});
  const Uncovered uncovered = find_uncovered(checked, spheres);
  page.add_dust("not covered", kUncoveredColor, uncovered.places, uncovered.until);
  if (checked.facts.self_intersections > 0) add_defects(page, find_defects(checked.solid));
  add_coverage(page, spheres, checked.facts.volume);
  page.steps() = {{"name", "spheres"},
                  {"count", spheres.size()},
                  {"start", spheres.size() - 1},
                  {"counts_up", true}};
  page.set_views({"overview", "side"});
  page.write(path);
}

}  // namespace vpm::tools
