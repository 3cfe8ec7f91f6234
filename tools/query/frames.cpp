// Mode of vpm-query that moves the tool, or a haptic device that holds it, through recorded frames.
#include "libvpm/core/error.h"
#include "libvpm/file/stream.h"
#include "tools/query/coupling_option.h"
#include "tools/query/query_report.h"
#include "tools/query/replay.h"
#include "tools/query/run_mode.h"

namespace vpm::tools {
namespace {

// Returns the parameters of --coupling, if it is given.
std::optional<CouplingParameters> coupling_of(const Arguments& a, const ToolModel& model) {
  if (a.coupling.empty()) return std::nullopt;
  const double rate = a.replay.rate.value_or(ReplayArguments::kRate);
  const CouplingParameters parameters = coupling_from_text(a.coupling, model, rate);
  if (a.replay.rate && rate != parameters.rate)
    throw Error(ErrorKind::invalid_argument,
                "--rate and the rate of --coupling differ; give one of them");
  return parameters;
}

}  // namespace

void run_frames(QuerySetup& setup) {
  const Arguments& a = setup.arguments;
  const ToolModel& model = setup.models.front();
  const std::optional<CouplingParameters> parameters = coupling_of(a, model);
  const double rate =
      parameters ? parameters->rate : a.replay.rate.value_or(ReplayArguments::kRate);
  Replay replay(setup.tool, a.replay, rate, setup.options.device, setup.points);
  const Pose first = replay.path().pose(0);
  LevelToolQuery query(model, setup.options, setup.level, replay.first_cloud(), first);
  note_scale(setup.tool, query);
  std::optional<VirtualCoupling> coupling;
  if (parameters) {
    note_coupling(setup.tool, *parameters, model, setup.options.stiffness);
    coupling.emplace(*parameters, model.center_of_mass, first);
  }
  file::Output output(a.output);
  replay.run(query, coupling, setup.options.measure, output, setup.view);
  output.finish();
  nlohmann::json stats =
      query_stats(replay.query_seconds(), replay.prepare_seconds(), a.deadline_us);
  stats["cloud_points"] = replay.last_cloud().positions().size();
  stats["replay"] = replay.report(a.deadline_us ? 1e-6 * *a.deadline_us : 1 / rate);
  add_level(stats, query);
  write_last_spheres(setup, query, replay.last_pose());
  write_stats_and_view(setup, std::move(stats));
}

}  // namespace vpm::tools
