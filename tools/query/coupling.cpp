// Mode of vpm-query that moves a haptic device, which holds the tool by a spring and a damper,
// along a path in a cloud.
#include "tools/query/coupling.h"

#include <vpm/error.h>

#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <numbers>

#include "libvpm/recording/timed_path.h"
#include "tools/common/recorded_frames.h"
#include "tools/query/cloud_scene.h"
#include "tools/query/mode.h"
#include "tools/query/query_report.h"
#include "tools/query/result_output.h"
#include "tools/query/solid_scene.h"

namespace vpm::tools {
namespace {

[[noreturn]] void wrong(const std::string& text) {
  throw Error(
      ErrorKind::invalid_argument,
      "--coupling " + text + ": give stiffness=N/m,damping=N s/m and, if wanted, mass=kg,rate=Hz");
}

double number_from(std::string_view value, const std::string& text) {
  double number = 0;
  const auto [stop, fault] = std::from_chars(value.data(), value.data() + value.size(), number);
  if (fault != std::errc() || stop != value.data() + value.size()) wrong(text);
  return number;
}

// Returns the stiffest contact that the tool can make, N/m. The force grows by stiffness times the
// cross-section for each metre, and a ball of the tool radius bounds that section.
double stiffest_contact(const Tool& tool, double stiffness) {
  return stiffness * std::numbers::pi * tool.radius() * tool.radius();
}

// Returns a warning if the parameters are unstable in a scene of this stiffness (N/m^3), otherwise
// "".
std::string coupling_warning(const CouplingParameters& p, const Tool& tool, double stiffness) {
  const double contact = stiffest_contact(tool, stiffness);
  const double limit = coupling_limits(p).contact_stiffness;
  if (contact <= limit) return "";
  char text[256];
  std::snprintf(text, sizeof text,
                "--coupling is stable against contacts up to %.3g N/m, but with --stiffness %.3g "
                "this tool can make one of %.3g N/m: take rate=%.0f or more, a larger mass, or "
                "less --stiffness",
                limit, stiffness, contact, std::ceil(stable_rate(p, contact)));
  return text;
}

// Returns a note on the damping that a real device needs to render this.
std::string coupling_note(const CouplingParameters& p) {
  char text[192];
  std::snprintf(text, sizeof text,
                "mass %.3g kg, radius of gyration %.3g m; to be passive a device that renders this "
                "needs a damping of its own of %.3g N s/m",
                p.mass, p.gyration, coupling_limits(p).device_damping);
  return text;
}

nlohmann::json list_of(Vec3 v) {
  return {v.x, v.y, v.z};
}
nlohmann::json list_of(const Pose& pose) {
  const Quaternion q = quaternion_from_rotation(pose.rotation);
  const Vec3 t = pose.translation;
  return {t.x, t.y, t.z, q.x, q.y, q.z, q.w};
}

struct CoupledRun {
  std::vector<double> seconds;  // time of each query, s
  Pose last;                    // last pose of the tool
};

// Moves the device along the path and writes a line for each step.
CoupledRun follow(const SampledPath& path, VirtualCoupling coupling, LevelQuery& query,
                  CloudScene& scene, std::optional<View>& view, ResultOutput& output) {
  CoupledRun run;
  for (std::size_t k = 0; k < path.steps(); ++k) {
    CoupledStep step{k, path.time(k), path.pose(k), coupling.tool(), {}, {}, {}};
    const std::vector<Pose> solids = path.solids(k);
    step.contact = query.run(scene.scene(), step.tool, 0, solids);
    scene.see(step.tool, 0, step.contact);
    run.seconds.push_back(query.seconds());
    if (view) view->add({step.tool, 0, solids}, step.contact, query);
    step.rendered = coupling.advance(step.device, step.contact.wrench);
    step.energy = coupling.energy();
    output.append(coupled_line(step, ""));
    run.last = step.tool;
  }
  return run;
}

}  // namespace

CouplingParameters coupling_from_text(const std::string& text, const Tool& tool, double rate) {
  CouplingParameters p;
  p.rate = rate;
  const std::array<std::pair<std::string_view, double*>, 4> known{
      {{"stiffness", &p.stiffness}, {"damping", &p.damping}, {"mass", &p.mass}, {"rate", &p.rate}}};
  std::string_view rest = text;
  while (!rest.empty()) {
    const std::string_view item = rest.substr(0, rest.find(','));
    rest.remove_prefix(std::min(item.size() + 1, rest.size()));
    const std::size_t equals = item.find('=');
    if (equals == std::string_view::npos) wrong(text);
    double* value = nullptr;
    for (const auto& [name, target] : known)
      if (name == item.substr(0, equals)) value = target;
    if (value == nullptr) wrong(text);
    *value = number_from(item.substr(equals + 1), text);
    if (!(*value > 0)) wrong(text);
  }
  if (!(p.stiffness > 0 && p.damping > 0)) wrong(text);
  if (p.mass == 0) p.mass = critical_mass(p.stiffness, p.damping);
  p.gyration = tool.gyration();
  validate(p);
  return p;
}

void note_coupling(const Program& program, const CouplingParameters& parameters, const Tool& tool,
                   double stiffness) {
  program.note("coupling: " + coupling_note(parameters));
  const std::string warning = coupling_warning(parameters, tool, stiffness);
  if (!warning.empty()) program.warn(warning);
}

nlohmann::ordered_json coupled_line(const CoupledStep& s, const std::string& frame) {
  nlohmann::ordered_json line;
  line["step"] = s.step;
  line["time"] = s.time;
  if (!frame.empty()) line["frame"] = frame;
  line["device"] = list_of(s.device);
  line["tool"] = list_of(s.tool);
  line["volume"] = s.contact.volume;
  line["volume_fraction"] = s.contact.volume_fraction;
  line["force"] = list_of(s.contact.wrench.force);
  line["torque"] = list_of(s.contact.wrench.torque);
  line["rendered_force"] = list_of(s.rendered.force);
  line["rendered_torque"] = list_of(s.rendered.torque);
  line["energy"] = {{"supplied", s.energy.supplied},
                    {"stored", s.energy.stored},
                    {"dissipated", s.energy.dissipated},
                    {"absorbed", s.energy.absorbed},
                    {"lost", s.energy.lost}};
  return line;
}

void run_coupling(QuerySetup& setup) {
  const Arguments& a = setup.arguments;
  const Tool& tool = setup.tools.front();
  CloudScene scene(setup);
  PoseReader reader(a.poses.front());
  ResultOutput output(setup.program, a, coupling_columns());
  const CouplingParameters parameters =
      coupling_from_text(a.coupling, tool, ReplayArguments::kRate);
  const SampledPath path(TimedPath(reader), parameters.rate);
  note_lines(setup.program, a.poses.front(), path.path().undefined(), path.path().doubled());
  check_moving_solids(a.poses.front(), path.path().solids(), a.solids.size());
  const Pose first = path.pose(0);
  LevelQuery query(tool, setup.options, setup.level, scene.scene(), first);
  note_scale(setup.program, query);
  note_coupling(setup.program, parameters, tool, setup.options.stiffness);
  CoupledRun run = follow(path, VirtualCoupling(parameters, tool.center_of_mass(), first), query,
                          scene, setup.view, output);
  output.finish();
  note_deviation(setup.program, "", reader.largest_deviation());
  scene.warn_at_end();
  nlohmann::json stats =
      query_stats(std::move(run.seconds), scene.prepare_seconds(), a.deadline_us);
  if (!a.clouds.empty()) stats["cloud_points"] = scene.points();
  add_levels(stats, query);
  write_last_spheres(setup, query, run.last);
  write_stats_and_view(setup, std::move(stats));
}

}  // namespace vpm::tools
