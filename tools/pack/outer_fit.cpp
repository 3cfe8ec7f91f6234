// vpm-pack --outer.
#include "tools/pack/outer_fit.h"

#include <algorithm>
#include <chrono>
#include <cstdio>

#include "libvpm/core/error.h"
#include "libvpm/file/stream.h"
#include "libvpm/packing/certificate.h"
#include "libvpm/packing/packing_export.h"
#include "tools/pack/pack_report.h"

namespace vpm::tools {
namespace {

// Returns the spheres as text of nine digits has them, of which each holds the one given, so that
// the proof is of what is written.
std::vector<Sphere> as_written(const std::vector<Sphere>& spheres) {
  std::vector<Sphere> written;
  for (const auto& [center, radius] : spheres) {
    const auto read_back = [](double value) { return std::stod(digits(value)); };
    const Vec3 moved{read_back(center.x), read_back(center.y), read_back(center.z)};
    written.push_back({moved, rounded_up(radius + norm(moved - center))});
  }
  std::ranges::sort(written, largest_first);
  return written;
}

}  // namespace

OuterFit outer_fit(const std::string& name, const CheckedSolid& checked, std::size_t count,
                   const Program& program) {
  Progress progress("holding " + name, program.common());
  OuterFit fit;
  fit.spheres = as_written(
      cover(checked.solid, count, &checked.enclosure, [&](double done) { progress.update(done); }));
  fit.certificate = certify_cover(checked.solid, fit.spheres, &checked.enclosure);
  if (fit.certificate.holds) return fit;
  const auto& [x, y, z] = fit.certificate.open;
  refuse("the spheres may leave out a place near " + std::to_string(x) + ", " + std::to_string(y) +
             ", " + std::to_string(z) + "; nothing is written.",
         name, "This is a bug of `pack`: please report it with the mesh");
}

nlohmann::json quality_of(const CheckedSolid& checked, const std::vector<Sphere>& spheres) {
  const CoverShares shares = cover_shares(checked.solid, spheres, &checked.enclosure);
  const double beyond = certify(checked.solid, spheres, &checked.enclosure).max_protrusion;
  return {{"coverage", shares.covered},
          {"protrusion", std::max(0.0, shares.protruding)},
          {"max_protrusion", std::max(0.0, beyond)},
          {"volume_ratio", volume_of(spheres) / checked.facts.volume}};
}

void run_outer(const Program& program, const Arguments& a, const CheckedSolid& checked) {
  const auto start = std::chrono::steady_clock::now();
  const OuterFit fit = outer_fit(a.mesh, checked, a.spheres, program);
  const std::vector<Sphere> spheres = inflated(a, fit.spheres);
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const nlohmann::json quality = quality_of(checked, spheres);
  if (!a.report.empty()) {
    const nlohmann::json report = {{"spheres", spheres.size()},
                                   {"outer", true},
                                   {"certified", fit.certificate.holds},
                                   {"cells", fit.certificate.cells},
                                   {"inflate", a.inflate},
                                   {"volume_mesh", checked.facts.volume},
                                   {"volume_spheres", volume_of(spheres)},
                                   {"r_min", spheres.back().radius},
                                   {"r_max", spheres.front().radius},
                                   {"seconds", seconds},
                                   {"quality", quality},
                                   {"notes", checked.notes},
                                   {"warnings", checked.warnings}};
    file::write_all(a.report, report.dump(2) + "\n");
  }
  write_exports(a, fit.spheres);
  char text[200];
  std::snprintf(text, sizeof text,
                "%zu sphere%s all of the solid, proven in %zu cells; %.3g %% of its volume lies "
                "in them outside of it, and none reaches further than %.3g mm out",
                spheres.size(), spheres.size() == 1 ? " holds" : "s hold", fit.certificate.cells,
                100 * quality["protrusion"].get<double>(),
                1000 * quality["max_protrusion"].get<double>());
  program.note(text);
}

}  // namespace vpm::tools
