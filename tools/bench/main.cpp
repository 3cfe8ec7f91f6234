// vpm-bench SUITE [--out DIR] [--quick]
#include <iostream>

#include "libvpm/core/error.h"
#include "tools/bench/suite.h"
#include "tools/common/number_checks.h"
#include "tools/common/tool.h"

int main(int argc, char** argv) {
  vpm::tools::Tool tool("vpm-bench",
                        "Measures accuracy and speed; writes JSON and CSV for scripts/plot_*.py");
  std::string suite, folder = "bench-output", meshes, data, shadows = "near";
  bool quick = false, all = false, baseline = false;
  std::uint64_t noise_seed = vpm::bench::SuiteOptions::kUsualNoise;
  tool.app().add_option("suite", suite, vpm::bench::suite_names());
  tool.app()
      .add_option("--out", folder, "Folder for SUITE.json and SUITE.csv")
      ->capture_default_str();
  tool.app().add_flag("--quick", quick, "A small version that takes seconds");
  tool.app().add_flag(
      "--all", all,
      "accuracy: every tool, scene and kind of cloud; packing, scaling: a million spheres");
  tool.app().add_option("--meshes", meshes,
                        "packing: folder of bunny.off, armadillo.obj, fandisk.obj and knot.ply");
  tool.app().add_option(
      "--data", data,
      "accuracy --all, replay, timing: folder whose depth/ holds recorded depth images; replay: or "
      "your own recording, with camera-intrinsics.txt (vpm-query --frames)");
  tool.app()
      .add_option("--noise-seed", noise_seed, "accuracy: which sample of the noise")
      ->check(vpm::tools::whole_number_in(0, 1 << 30))
      ->capture_default_str();
  tool.app()
      .add_option("--shadows", shadows,
                  "accuracy: what counts of places that a depth image does not show, near ones or "
                  "all (solid, of images alone)")
      ->check(CLI::IsMember({"near", "solid"}))
      ->capture_default_str();
  tool.app().add_flag("--baseline", baseline,
                      "scaling: beside the measure as printed, by the algorithm as printed");
  tool.app()
      .get_option("--device")
      ->description("Where to query, with the same results: cpu, and of " +
                    vpm::bench::suite_names(true) +
                    " cuda or cuda:N; auto is the CPU, of scaling, which times a device, cuda");
  tool.computes_on_devices();
  return tool.run(argc, argv, [&] {
    const bool asks_device = tool.common().device != "auto" || vpm::bench::needs_device(suite);
    if (vpm::bench::is_suite(suite)) vpm::bench::make_folder(folder);
    vpm::tools::Progress progress("vpm-bench " + suite, tool.common());
    const vpm::bench::Report report = vpm::bench::run_suite(
        suite, {quick, all, [&](double fraction) { progress.update(fraction); }, meshes, data,
                baseline, noise_seed, shadows == "solid" ? vpm::Shadows::solid : vpm::Shadows::near,
                asks_device ? tool.device() : vpm::Device{}});
    vpm::bench::write(
        report,
        "vpm-bench " + suite + (quick ? " --quick" : "") + (all ? " --all" : "") +
            (baseline ? " --baseline" : "") +
            (noise_seed == vpm::bench::SuiteOptions::kUsualNoise
                 ? ""
                 : " --noise-seed " + std::to_string(noise_seed)) +
            (shadows == "near" ? "" : " --shadows " + shadows) +
            (tool.common().device == "auto" ? "" : " --device " + tool.common().device) +
            (meshes.empty() ? "" : " --meshes MESHES") + (data.empty() ? "" : " --data DATA"),
        folder);
    if (!tool.common().quiet) std::cout << report.summary << std::flush;
    if (!report.failure.empty())
      vpm::refuse(report.failure + "; " + folder + "/" + suite + ".json names them");
  });
}
