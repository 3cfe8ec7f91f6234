// Mode of vpm-query that moves a haptic device, which holds the tool by a spring and a damper,
// along a path in a cloud.
#include "libvpm/file/stream.h"
#include "libvpm/haptics/virtual_coupling.h"
#include "libvpm/recording/timed_path.h"
#include "tools/query/cloud_scene.h"
#include "tools/query/coupled_step.h"
#include "tools/query/coupling_option.h"
#include "tools/query/query_report.h"
#include "tools/query/run_mode.h"

namespace vpm::tools {
namespace {

struct CoupledRun {
  std::vector<double> seconds;  // time of each query, s
  Pose last;                    // last pose of the tool
};

// Moves the device along the path and writes a line for each step.
CoupledRun follow(const SampledPath& path, VirtualCoupling coupling, LevelToolQuery& query,
                  CloudScene& scene, std::optional<PoseView>& view, file::Output& output) {
  CoupledRun run;
  for (std::size_t k = 0; k < path.steps(); ++k) {
    CoupledStep step{k, path.time(k), path.pose(k), coupling.tool(), {}, {}, {}};
    step.contact = query.run(scene.cloud(), step.tool);
    scene.check().see(step.tool, 0, step.contact);
    run.seconds.push_back(query.seconds());
    if (view) view->add(0, step.tool, step.contact, query.query());
    step.rendered = coupling.advance(step.device, step.contact.wrench);
    step.energy = coupling.energy();
    output.append(coupled_line(step, ""));
    run.last = step.tool;
  }
  return run;
}

}  // namespace

void run_coupling(QuerySetup& setup) {
  const Arguments& a = setup.arguments;
  const ToolModel& model = setup.models.front();
  CloudScene scene(setup);
  PoseReader reader(a.poses);
  file::Output output(a.output);
  const CouplingParameters parameters =
      coupling_from_text(a.coupling, model, ReplayArguments::kRate);
  const SampledPath path(TimedPath(reader), parameters.rate);
  const Pose first = path.pose(0);
  LevelToolQuery query(model, setup.options, setup.level, scene.cloud(), first);
  note_scale(setup.tool, query);
  note_coupling(setup.tool, parameters, model, setup.options.stiffness);
  CoupledRun run = follow(path, VirtualCoupling(parameters, model.center_of_mass, first), query,
                          scene, setup.view, output);
  output.finish();
  note_deviation(setup.tool, "", reader.largest_deviation());
  scene.check().warn_at_end();
  nlohmann::json stats =
      query_stats(std::move(run.seconds), scene.prepare_seconds(), a.deadline_us);
  stats["cloud_points"] = scene.cloud().positions().size();
  add_level(stats, query);
  write_last_spheres(setup, query, run.last);
  write_stats_and_view(setup, std::move(stats));
}

}  // namespace vpm::tools
