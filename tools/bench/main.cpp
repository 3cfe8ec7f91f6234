// vpm-bench: runs a suite of measurements and writes its results.
#include <iostream>

#include "libvpm/core/error.h"
#include "tools/bench/suite.h"
#include "tools/common/number_checks.h"
#include "tools/common/program.h"

namespace vpm::bench {
namespace {

struct Arguments {
  std::string suite, folder = "bench-output", meshes, data, shadows = "near";
  bool quick = false, all = false;
  std::uint64_t noise_seed = SuiteOptions::kUsualNoise;
};

void declare(CLI::App& app, Arguments& a) {
  app.add_option("suite", a.suite, "Suite to run: " + suite_names());
  tools::begin_group(app, "Suites");
  app.add_option(
         "--out", a.folder,
         "Write SUITE.json and SUITE.csv into this folder, which is made if the one above is there")
      ->capture_default_str()
      ->option_text("FOLDER");
  app.add_flag("--quick", a.quick, "Run a small version that takes seconds");
  app.add_flag("--all", a.all,
               "accuracy: take every tool, scene and kind of cloud; packing, scaling: go up to a "
               "million spheres");
  app.add_option(
         "--meshes", a.meshes,
         "packing: folder of bunny.off, armadillo.obj, fandisk.obj and knot.ply; pairs, peers: of "
         "those and spot.obj, as far as they are there")
      ->option_text("FOLDER");
  app.add_option(
         "--data", a.data,
         "accuracy --all, peers, replay, timing: folder whose depth/ has recorded depth images; "
         "replay: or a recording with camera-intrinsics.txt, as for vpm-query --frames")
      ->option_text("FOLDER");
  tools::begin_group(app, "Accuracy", tools::Group::rare);
  app.add_option("--noise-seed", a.noise_seed, "accuracy: sample of the noise")
      ->check(tools::whole_number_in(0, 1 << 30))
      ->capture_default_str();
  app.add_option("--shadows", a.shadows,
                 "accuracy: what counts of the places that a depth image does not show: near ones, "
                 "or all (solid)")
      ->check(CLI::IsMember({"near", "solid"}))
      ->capture_default_str();
  app.get_option("--device")
      ->description(
          "Compute queries on cpu, or, in " + suite_names(true) +
          ", on cuda or cuda:N, with the same results. auto is the CPU, and cuda for scaling");
}

// Returns the command that repeats the run, with placeholders for folders.
std::string command_of(const Arguments& a, const std::string& device, int threads) {
  const bool usual_noise = a.noise_seed == SuiteOptions::kUsualNoise;
  return "vpm-bench " + a.suite + (a.quick ? " --quick" : "") + (a.all ? " --all" : "") +
         (usual_noise ? "" : " --noise-seed " + std::to_string(a.noise_seed)) +
         (a.shadows == "near" ? "" : " --shadows " + a.shadows) +
         (device == "auto" ? "" : " --device " + device) +
         (threads == 0 ? "" : " --threads " + std::to_string(threads)) +
         (a.meshes.empty() ? "" : " --meshes MESHES") + (a.data.empty() ? "" : " --data DATA");
}

void run(const tools::Program& program, const Arguments& a) {
  const std::string& device = program.common().device;
  const bool asks_device = device != "auto" || needs_device(a.suite);
  if (is_suite(a.suite)) {
    make_folder(a.folder);
    tools::check_files({},
                       {{"--out", a.folder + "/" + a.suite + ".json", {}},
                        {"--out", a.folder + "/" + a.suite + ".csv", {}}},
                       program.common());
  }
  tools::Progress progress("vpm-bench " + a.suite, program.common());
  const Report report =
      run_suite(a.suite, {.quick = a.quick,
                          .all = a.all,
                          .progress = [&](double fraction) { progress.update(fraction); },
                          .meshes = a.meshes,
                          .data = a.data,
                          .noise_seed = a.noise_seed,
                          .shadows = a.shadows == "solid" ? Shadows::solid : Shadows::near,
                          .device = asks_device ? program.device() : Device{},
                          .threads = program.common().threads});
  write(report, command_of(a, device, program.common().threads), a.folder);
  if (!program.common().quiet) std::cout << report.summary << std::flush;
  if (!report.failure.empty())
    refuse(report.failure + "; " + a.folder + "/" + a.suite + ".json names them");
}

}  // namespace
}  // namespace vpm::bench

int main(int argc, char** argv) {
  vpm::tools::Program program("vpm-bench", "Measure accuracy and speed; write JSON and CSV");
  vpm::bench::Arguments arguments;
  declare(program.app(), arguments);
  program.show_examples({
      "vpm-bench accuracy --quick --out bench",
      "vpm-bench extremes --quick --device cpu --out bench",
      "vpm-bench packing --quick --out bench",
  });
  program.computes_on_devices();
  return program.run(argc, argv, [&] { run(program, arguments); });
}
