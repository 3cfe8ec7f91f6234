// Measures packings: coverage, time and memory, the gain by growing, the cost per sphere up to a
// million spheres and per mesh up to two million triangles, and the time in smooth solids.

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <functional>
#include <optional>

#include "libvpm/file/stream.h"
#include "libvpm/mesh/mesh_check.h"
#include "libvpm/mesh/mesh_reader.h"
#include "libvpm/packing/certificate.h"
#include "libvpm/packing/grow.h"
#include "libvpm/packing/outer_cover.h"
#include "libvpm/packing/packer.h"
#include "libvpm/synthetic/shapes.h"
#include "tools/bench/peak_memory.h"
#include "tools/bench/smooth_solids.h"
#include "tools/bench/statistics.h"
#include "tools/bench/suite.h"

namespace vpm::bench {
namespace {

struct Shape {
  std::string name;
  Solid solid;
  Enclosure enclosure;
  double volume = 0;  // m^3
};

struct Cost {
  double seconds = 0, cpu_seconds = 0, memory_mb = 0;
};

Cost operator+(const Cost& a, const Cost& b) {
  return {a.seconds + b.seconds, a.cpu_seconds + b.cpu_seconds, std::max(a.memory_mb, b.memory_mb)};
}

Cost cost_of(const std::function<void()>& work) {
  reset_peak_memory();
  const auto start = std::chrono::steady_clock::now();
  const double cpu = process_seconds();
  work();
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
  return {taken.count(), process_seconds() - cpu, peak_memory_mb()};
}

double filled(const std::vector<Sphere>& spheres) {
  double sum = 0;
  for (const Sphere& s : spheres) sum += volume(s);
  return sum;
}

// Returns 1, 2, 5, 10, 20 ... up to `most`.
std::vector<std::size_t> counts_up_to(std::size_t most) {
  std::vector<std::size_t> counts;
  for (std::size_t decade = 1; decade <= most; decade *= 10)
    for (const std::size_t n : {decade, 2 * decade, 5 * decade})
      if (n <= most) counts.push_back(n);
  return counts;
}

template <typename... Values>
std::string format(const char* pattern, Values... values) {
  char text[256];
  std::snprintf(text, sizeof text, pattern, values...);
  return text;
}

class Packings {
 public:
  explicit Packings(const SuiteOptions& options)
      : options_(options), most_(options.quick ? 1000 : 10000) {
    report_.suite = "packing";
    report_.settings = {{"quick", options.quick}, {"all", options.all}, {"spheres", most_}};
    report_.table.columns = {"part",     "shape",   "method",      "spheres",
                             "coverage", "seconds", "cpu_seconds", "memory_mb"};
    make_shapes();
  }

  Report run() {
    compare();
    grow_together();
    count_what_is_needed();
    hold_all();
    scale_up();
    refine_mesh();
    fill_smooth_solids();
    return std::move(report_);
  }

 private:
  void add_shape(const std::string& name, Solid solid) {
    Enclosure enclosure = enclosure_of(solid);
    const double volume = enclosure.volume;
    shapes_.push_back({name, std::move(solid), std::move(enclosure), volume});
  }

  void make_shapes() {
    add_shape("cube", synthetic::make_cube(1));
    add_shape("tetrahedron", synthetic::make_tetrahedron(1));
    add_shape("octahedron", synthetic::make_octahedron(1));
    add_shape("torus knot", make_torus_knot(1));
    for (const auto& [name, file] : {std::pair{"bunny", "bunny.off"},
                                     {"armadillo", "armadillo.obj"},
                                     {"fandisk", "fandisk.obj"},
                                     {"knot.ply", "knot.ply"}}) {
      const std::string path = options_.meshes + "/" + file;
      if (options_.meshes.empty()) continue;
      add_shape(name, make_solid(parse_mesh(file::read_all(path), path), {}).solid);
    }
    nlohmann::json names = nlohmann::json::array();
    for (const Shape& s : shapes_) names.push_back(s.name);
    report_.settings["shapes"] = names;
  }

  void add(const std::string& part, const std::string& shape, const std::string& method,
           std::size_t spheres, double coverage, const Cost& cost) {
    const auto count = static_cast<double>(spheres);
    report_.table.rows.push_back(
        {part, shape, method, count, coverage, cost.seconds, cost.cpu_seconds, cost.memory_mb});
    report_.results.push_back({{"part", part},
                               {"shape", shape},
                               {"method", method},
                               {"spheres", spheres},
                               {"coverage", coverage},
                               {"seconds", cost.seconds},
                               {"cpu_seconds", cost.cpu_seconds},
                               {"memory_mb", cost.memory_mb}});
  }

  void progress(double fraction) const {
    if (options_.progress) options_.progress(fraction);
  }

  // Adds the coverage of every prefix, one line of the comparison each.
  void add_prefixes(const Shape& shape, const std::string& method,
                    const std::vector<Sphere>& spheres, const Cost& cost) {
    std::string line = "| " + shape.name + " | " + method + " |";
    double sum = 0;
    const std::vector<std::size_t> counts = counts_up_to(most_);
    auto next = counts.begin();
    for (std::size_t i = 0; i < spheres.size() && next != counts.end(); ++i) {
      sum += volume(spheres[i]);
      if (i + 1 != *next) continue;
      add("coverage", shape.name, method, *next, sum / shape.volume, cost);
      if (std::to_string(*next).front() == '1') line += format(" %.4f |", sum / shape.volume);
      ++next;
    }
    if (spheres.size() < most_) line += format(" (%zu spheres) |", spheres.size());
    report_.summary +=
        line + format(" %.2f | %.2f | %.0f |\n", cost.seconds, cost.cpu_seconds, cost.memory_mb);
  }

  void compare() {
    report_.summary += "| shape | packer |";
    std::string rule = "|---|---|";
    for (std::size_t n = 1; n <= most_; n *= 10) {
      report_.summary += " " + std::to_string(n) + " |";
      rule += "---|";
    }
    report_.summary += " s | CPU s | MB |\n" + rule + "---|---|---|\n";
    for (const Shape& shape : shapes_) {
      std::vector<Sphere> spheres;
      PackOptions pack_options;
      pack_options.spheres = most_;
      pack_options.enclosure = &shape.enclosure;  // vpm-pack has it from its check of the mesh
      const Cost cost = cost_of([&] { spheres = pack(shape.solid, pack_options).spheres; });
      add_prefixes(shape, "vpm-pack", spheres, cost);
      progress(0.6 * ++done_ / static_cast<double>(shapes_.size()));
    }
  }

  std::vector<Sphere> greedy(const Shape& shape, std::size_t spheres) const {
    PackOptions pack_options;
    pack_options.spheres = spheres;
    pack_options.enclosure = &shape.enclosure;
    return pack(shape.solid, pack_options).spheres;
  }

  void grow_together() {
    report_.summary +=
        "\n| shape | spheres | upper bound: so many largest balls | greedy | --grow | points | CPU "
        "s |\n"
        "|---|---|---|---|---|---|---|\n";
    for (const Shape& shape : shapes_) {
      for (const std::size_t n : {std::size_t{10}, std::size_t{100}, std::size_t{1000}}) {
        if (n > most_ / 10) continue;
        std::vector<Sphere> spheres = greedy(shape, n);
        const double before = filled(spheres) / shape.volume;
        const double bound =
            std::min(1.0, static_cast<double>(n) * volume(spheres.front()) / shape.volume);
        const Cost cost =
            cost_of([&] { spheres = grow(shape.solid, spheres, {.enclosure = &shape.enclosure}); });
        const double after = filled(spheres) / shape.volume;
        add("growth", shape.name, "largest balls", n, bound, {});
        add("growth", shape.name, "greedy", n, before, {});
        add("growth", shape.name, "grown", n, after, cost);
        report_.summary +=
            format("| %s | %zu | %.4f | %.4f | %.4f | %+.2f | %.2f |\n", shape.name.c_str(), n,
                   bound, before, after, 100 * (after - before), cost.cpu_seconds);
      }
    }
    progress(0.7);
  }

  // Compares spheres in a solid with those that hold all of it, as the fits of others are reported.
  void hold_all() {
    report_.summary +=
        "\n| shape | spheres | method | covered | outside of the solid, of its volume | reach "
        "beyond it, of "
        "its longest side | proven | CPU s |\n|---|---|---|---|---|---|---|---|\n";
    for (const Shape& shape : shapes_)
      for (const std::size_t n : {std::size_t{10}, std::size_t{100}}) {
        add_fit(shape, "greedy", greedy(shape, n), {});
        std::vector<Sphere> spheres;
        const Cost cost = cost_of([&] { spheres = cover(shape.solid, n, &shape.enclosure); });
        add_fit(shape, "outer", spheres, cost);
      }
  }

  void add_fit(const Shape& shape, const std::string& method, const std::vector<Sphere>& spheres,
               const Cost& cost) {
    const bool is_outer = method == "outer";
    const CoverShares shares = cover_shares(shape.solid, spheres, &shape.enclosure);
    const Certificate certificate = certify(shape.solid, spheres, &shape.enclosure);
    const bool holds =
        is_outer ? certify_cover(shape.solid, spheres, &shape.enclosure).holds : certificate.holds;
    const double longest = certificate.tolerance / kCertificateTolerance;
    const double beyond = std::max(0.0, certificate.max_protrusion) / longest;
    add("fit", shape.name, method, spheres.size(), shares.covered, cost);
    report_.results.back()["protrusion"] = shares.protruding;
    report_.results.back()["max_protrusion"] = beyond;
    report_.results.back()["certified"] = holds;
    report_.summary += format("| %s | %zu | %s | %.4f | %.4f | %.4f | %s | %.2f |\n",
                              shape.name.c_str(), spheres.size(), method.c_str(), shares.covered,
                              shares.protruding, beyond, holds ? "yes" : "NO", cost.cpu_seconds);
    if (!holds) report_.failure = "a packing or cover does not hold its certificate";
  }

  // Finds the fewest spheres that cover a fraction of the volume, greedy and grown.
  void count_what_is_needed() {
    report_.summary +=
        "\n| shape | coverage | spheres, greedy | spheres, --grow |\n"
        "|---|---|---|---|\n";
    for (const Shape& shape : shapes_) {
      const std::vector<Sphere> many = greedy(shape, kMostNeeded);
      for (const double coverage : {0.5, 0.6, 0.65, 0.7}) {
        std::size_t spheres = 0;
        for (double sum = 0; spheres < many.size() && sum < coverage * shape.volume; ++spheres)
          sum += volume(many[spheres]);
        if (spheres == many.size() || spheres < 2) continue;
        const std::size_t grown = needed_with_growth(shape, many, spheres, coverage);
        add("needed", shape.name, "greedy", spheres, coverage, {});
        add("needed", shape.name, "grown", grown, coverage, {});
        report_.summary += format("| %s | %.0f %% | %zu | %zu |\n", shape.name.c_str(),
                                  100 * coverage, spheres, grown);
      }
    }
    progress(0.8);
  }

  // Bisects, since coverage rises with the number of spheres with rare exceptions.
  static std::size_t needed_with_growth(const Shape& shape, const std::vector<Sphere>& greedy,
                                        std::size_t enough, double coverage) {
    std::size_t too_few = 0;
    while (enough - too_few > 1) {
      const std::size_t n = (enough + too_few) / 2;
      const auto end = greedy.begin() + static_cast<std::ptrdiff_t>(n);
      const double grown =
          filled(grow(shape.solid, {greedy.begin(), end}, {.enclosure = &shape.enclosure}));
      (grown >= coverage * shape.volume ? enough : too_few) = n;
    }
    return enough;
  }

  // Measures the cost per sphere in the bunny if its mesh is given, otherwise in the torus knot.
  void scale_up() {
    const auto found = std::find_if(shapes_.begin(), shapes_.end(),
                                    [](const Shape& s) { return s.name == "bunny"; });
    const Shape& shape = found != shapes_.end() ? *found : shapes_[3];
    const std::size_t most = options_.quick ? 10000 : options_.all ? 1000000 : 100000;
    report_.summary += "\n| " + shape.name +
                       ": spheres | coverage | s | CPU s | CPU µs per sphere | MB | certified |\n"
                       "|---|---|---|---|---|---|---|\n";
    for (const std::size_t n : {100, 300, 1000, 3000, 10000, 30000, 100000, 300000, 1000000}) {
      if (n > most) break;
      PackResult result;
      PackOptions pack_options;
      pack_options.spheres = n;
      const Cost cost = cost_of([&] { result = pack(shape.solid, pack_options); });
      const bool holds = certify(shape.solid, result.spheres).holds;
      add("scaling", shape.name, "vpm-pack", result.spheres.size(), result.coverage, cost);
      report_.summary += format("| %zu | %.4f | %.2f | %.2f | %.0f | %.0f | %s |\n",
                                result.spheres.size(), result.coverage, cost.seconds,
                                cost.cpu_seconds, 1e6 * cost.cpu_seconds / static_cast<double>(n),
                                cost.memory_mb, holds ? "yes" : "NO");
      if (!holds) report_.failure = "a packing does not hold its certificate";
    }
    progress(0.9);
  }

  // Measures the torus knot with 11 520 to two million triangles: all that vpm-pack does except
  // reading.
  void refine_mesh() {
    report_.summary +=
        "\n| torus knot: triangles | coverage | s, mesh | s, packing | CPU s | MB | certified |\n"
        "|---|---|---|---|---|---|---|\n";
    for (const int fine : {1, 4, 14}) {
      if (options_.quick && fine > 4) break;
      const RawMesh mesh = raw_torus_knot(fine);
      CheckedSolid checked;
      PackResult result;
      PackOptions pack_options;
      pack_options.spheres = most_;
      bool holds = false;
      const Cost check = cost_of([&] { checked = make_solid(mesh); });
      const Cost packing = cost_of([&] {
        pack_options.enclosure = &checked.enclosure;
        result = pack(checked.solid, pack_options);
        holds = certify(checked.solid, result.spheres, &checked.enclosure).holds;
      });
      const Cost both = check + packing;
      add("triangles", "torus knot", std::to_string(checked.facts.triangles) + " triangles",
          result.spheres.size(), result.coverage, both);
      report_.summary +=
          format("| %zu | %.4f | %.2f | %.2f | %.2f | %.0f | %s |\n", checked.facts.triangles,
                 result.coverage, check.seconds, packing.seconds, both.cpu_seconds, both.memory_mb,
                 holds ? "yes" : "NO");
      if (!holds) report_.failure = "a packing does not hold its certificate";
    }
    progress(0.95);
  }

  // Packs smooth solids on one thread, beside a capsule, whose time is the yardstick: where many
  // places have nearly equal room, bounds of it rule few of them out.
  void fill_smooth_solids() {
    const ThreadCap cap(options_, 1);
    report_.summary +=
        "\n| smooth solid: triangles | spheres | coverage | CPU s | to the capsule | certified |\n"
        "|---|---|---|---|---|---|\n";
    double yardstick = 0;  // CPU seconds of the first, the capsule
    for (const SmoothSolid& shape : smooth_solids(options_.quick)) {
      const Enclosure enclosure = enclosure_of(shape.solid);
      PackOptions pack_options;
      pack_options.spheres = kInSmoothSolids;
      pack_options.enclosure = &enclosure;
      PackResult result;
      const Cost cost = cost_of([&] { result = pack(shape.solid, pack_options); });
      if (!(yardstick > 0)) yardstick = cost.cpu_seconds;
      const double ratio = cost.cpu_seconds / yardstick;
      const bool holds = certify(shape.solid, result.spheres, &enclosure).holds;
      const std::size_t triangles = shape.solid.triangles.size();
      add("smooth", shape.name, std::to_string(triangles) + " triangles", result.spheres.size(),
          result.coverage, cost);
      report_.results.back()["to_capsule"] = ratio;
      report_.results.back()["certified"] = holds;
      report_.summary += format("| %s: %zu | %zu | %.4f | %.2f | %.1f | %s |\n", shape.name.c_str(),
                                triangles, result.spheres.size(), result.coverage, cost.cpu_seconds,
                                ratio, holds ? "yes" : "NO");
      if (!holds) report_.failure = "a packing does not hold its certificate";
    }
    progress(1);
  }

  static RawMesh raw_torus_knot(int fine) {
    const Solid solid = make_torus_knot(fine);
    RawMesh mesh;
    mesh.name = "torus knot";
    mesh.vertices = solid.vertices;
    for (const Triangle& t : solid.triangles) mesh.add_triangle(t);
    return mesh;
  }

  // Makes a torus knot whose first sphere fills .0146 of it, as the (2,3) knot of the literature.
  static Solid make_torus_knot(int fine) {
    return synthetic::make_torus_knot(2, 3, 1, 0.5, 0.177, 240 * fine, 24 * fine);
  }

  static constexpr std::size_t kMostNeeded = 400, kInSmoothSolids = 1000;

  const SuiteOptions& options_;
  std::size_t most_;
  std::vector<Shape> shapes_;
  Report report_;
  int done_ = 0;
};

}  // namespace

Report run_packing(const SuiteOptions& options) {
  return Packings(options).run();
}

}  // namespace vpm::bench
