// vpm-pack: fills a mesh with spheres that neither overlap nor protrude.

#include <vpm/level_query.h>
#include <vpm/scene.h>
#include <vpm/version.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "libvpm/core/error.h"
#include "libvpm/file/checksum.h"
#include "libvpm/file/overwrite.h"
#include "libvpm/file/stream.h"
#include "libvpm/mesh/mesh_check.h"
#include "libvpm/mesh/mesh_reader.h"
#include "libvpm/model/packing.h"
#include "libvpm/packing/certificate.h"
#include "libvpm/packing/grow.h"
#include "libvpm/packing/packer.h"
#include "libvpm/packing/packing_export.h"
#include "libvpm/packing/validation.h"
#include "libvpm/view/page.h"
#include "tools/common/error_text.h"
#include "tools/common/given_options.h"
#include "tools/common/list_run.h"
#include "tools/common/list_worker.h"
#include "tools/common/number_checks.h"
#include "tools/common/program.h"
#include "tools/common/repair_option.h"
#include "tools/common/scene_report.h"
#include "tools/pack/arguments.h"
#include "tools/pack/pack_report.h"
#include "tools/pack/pack_view.h"

namespace vpm::tools {
namespace {

constexpr long long kMostSpheres = 0xFFFFFFFE;  // a packing file counts them in 32 bits

// Adds the options that say which spheres are wanted.
void declare_spheres(CLI::App& app, Arguments& a) {
  begin_group(app, "Spheres");
  app.add_option("--spheres", a.spheres, "Stop after this many spheres")
      ->check(whole_number_in(1, kMostSpheres))
      ->capture_default_str();
  app.add_option(
         "--robot-spheres", a.robot_spheres,
         "With --urdf: so many spheres for the whole robot, shared by the links' volumes, in "
         "place of --spheres for each link")
      ->check(whole_number_in(1, kMostSpheres));
  app.add_flag("--outer", a.outer,
               "Let the spheres hold every point of the solid, which is proven, rather than lie in "
               "it: exactly --spheres, which overlap");
  app.add_option("--inflate", a.inflate, "Write all radii larger by this, metres")
      ->check(number_in(0, 1e300))
      ->capture_default_str()
      ->option_text("M");
  app.add_option("--coverage", a.coverage, "Stop at this fraction of the solid's volume, 0 to 1")
      ->capture_default_str()
      ->option_text("F");
  app.add_flag("--grow", a.grow,
               "Let all spheres grow and move together afterwards, which raises the coverage");
  begin_group(app, "Which spheres", Group::rare);
  app.add_option(
         "--inertia-error", a.inertia_error,
         "Stop when the inertia tensor (at equal mass, about the solid's centre of mass) differs "
         "from the solid's by at most this fraction, e.g. 0.01")
      ->check(positive_number())
      ->option_text("F");
  app.add_option("--min-radius", a.min_radius, "Place no smaller sphere, metres")
      ->capture_default_str()
      ->option_text("R");
  app.add_option("--max-radius", a.max_radius, "Place no larger sphere, metres")->option_text("R");
  app.add_option("--for-scene", a.for_scene,
                 "Cloud (.vpmc): place no spheres smaller than its points resolve, and none larger "
                 "than its curvature allows")
      ->option_text("CLOUD");
}

// Adds the options that say what is told of the spheres, and where.
void declare_reports(CLI::App& app, Arguments& a) {
  begin_group(app, "Outputs");
  app.add_option("-o,--output", a.output, "Packing to write (.vpmp); - is standard output");
  app.add_flag("--validate", a.validate,
               "Measure coverage, protrusion and overlap again by counting voxels (OpenVDB)");
  app.add_option("--report", a.report, "Write facts about mesh and packing here (JSON)");
  app.add_option(
      "--view", a.view,
      "Write a page (.html) here that shows solid, spheres and coverage in a browser, or "
      "the defects of a mesh that is refused");
  app.add_option(
         "--export", a.exports,
         "Write the spheres here too: .csv, .json, .ply (balls), .points.ply, .glb, .vtk, .yml "
         "(cuRobo), .xrdf, .urdf or .srdf. Can be given several times")
      ->allow_extra_args(false)
      ->option_text("FILE");
  app.add_option(
         "--level", a.level,
         "Of a packing or tool model: the largest N spheres only; of a model one of its levels")
      ->check(whole_number_in(0, kMostSpheres))
      ->capture_default_str();
  app.add_option("--link", a.link,
                 "Name of the link in .yml, .xrdf, .urdf and .srdf; the mesh's name if not given")
      ->option_text("NAME");
}

// Adds the options that say how the mesh is taken.
void declare_mesh(CLI::App& app, Arguments& a) {
  begin_group(app, "Mesh");
  a.scale_option =
      app.add_option("--scale", a.scale, "Unit of the mesh in metres: 0.001 for millimetres")
          ->capture_default_str()
          ->option_text("S");
  app.add_option("--repair", a.repair,
                 "Repair an open mesh. holes, which is meant if no value follows, fills planar and "
                 "small holes. voxel[=RES] makes a new surface around the places that the mesh "
                 "encloses by its winding number, from RES voxels (128) along the longest side. "
                 "flood[=RES] makes one around the places that cannot be reached from outside "
                 "through holes up to --max-hole")
      ->expected(0, 1)
      ->default_str("holes")
      ->option_text("[holes|voxel|flood]");
  begin_group(app, "More of the mesh", Group::rare);
  app.add_option("--node", a.node,
                 "Read only this node of a COLLADA, glTF, 3MF or FBX file, with those below it")
      ->option_text("NAME");
  app.add_option("--weld", a.weld,
                 "Join vertices nearer than this fraction of the mesh's diagonal (STL: 1e-9)")
      ->option_text("F");
  app.add_option(
         "--max-hole", a.max_hole,
         "Refuse meshes with wider holes, metres; with --repair voxel or flood, where flood "
         "takes 1/16 of the longest side if it is not given")
      ->check(positive_number())
      ->option_text("W");
}

// Adds the options of robots.
void declare_robot(CLI::App& app, Arguments& a) {
  begin_group(app, "Robots");
  app.add_option("--urdf", a.urdf,
                 "In place of a mesh: a URDF file. The collision geometry of each of its links is "
                 "packed; --output names a folder then, for a packing of each");
  app.add_option("--package-path", a.packages,
                 "Folder that holds the packages which package:// names in a URDF, or that is one. "
                 "Can be given several times")
      ->allow_extra_args(false)
      ->option_text("FOLDER");
}

void declare(CLI::App& app, Arguments& a) {
  app.add_option("mesh", a.mesh,
                 "Closed mesh: OBJ, OFF, PLY, STL, OM, COLLADA, glTF, 3MF or FBX; - is standard "
                 "input. Or a packing or tool model, whose spheres are written by --export");
  declare_reports(app, a);
  declare_spheres(app, a);
  declare_robot(app, a);
  declare_mesh(app, a);
}

// True for what cannot be meant as a mesh: a word without a suffix, and no file.
bool is_bare_word(std::string_view word) {
  std::error_code fault;
  return !word.empty() && word[0] != '-' && word.find_first_of("./") == word.npos &&
         !std::filesystem::exists(word, fault);
}

// Returns the arguments with a bare --repair replaced by `holes`, since CLI11 would take a mesh
// that follows for its value.
std::vector<char*> with_plain_repair(int argc, char** argv, std::string& holes) {
  std::vector<char*> arguments(argv, argv + argc);
  for (std::size_t k = 1; k < arguments.size(); ++k) {
    if (arguments[k] != std::string_view("--repair")) continue;
    const std::string_view next = k + 1 < arguments.size() ? arguments[k + 1] : "";
    const std::string_view mode = next.substr(0, next.find('='));
    if (mode != "holes" && mode != "voxel" && mode != "flood" && !is_bare_word(next))
      arguments[k] = holes.data();
  }
  return arguments;
}

// Returns the name that a robot description gives the part: --link, or the mesh's file name without
// folder and extension.
std::string link_name(const Arguments& a) {
  if (!a.link.empty()) return a.link;
  const std::string name = a.mesh.substr(a.mesh.rfind('/') + 1);
  return a.mesh == "-" ? "tool" : name.substr(0, name.rfind('.'));
}

// What is made of the mesh, or of what takes its place.
enum class Job { pack, outer, ready, robot };

Job job_of(const Arguments& a) {
  if (!a.urdf.empty()) return Job::robot;
  // With --output it is meant as a mesh, and the reader of meshes says what it is ready for.
  if (file::is_container(a.mesh) && a.output.empty()) return Job::ready;
  return a.outer ? Job::outer : Job::pack;
}

// Throws Error(invalid_argument) if an option is given that does not go with the job.
void check_options(const CLI::App& app, Job job) {
  struct Misplaced {
    const char* with;
    std::vector<const char*> options;
  };
  const std::vector<const char*> of_packing{"--coverage",   "--inertia-error", "--min-radius",
                                            "--max-radius", "--for-scene",     "--validate",
                                            "--view"};
  std::map<Job, Misplaced> rules{
      {Job::pack, {"a mesh", {"--level", "--robot-spheres", "--package-path"}}},
      {Job::outer, {"--outer", {"--level", "--robot-spheres", "--package-path", "--grow"}}},
      {Job::ready,
       {"a packing or tool model",
        {"--outer", "--robot-spheres", "--package-path", "--grow", "--spheres", "--report",
         "--node", "--scale", "--weld", "--repair", "--max-hole"}}},
      {Job::robot, {"--urdf", {"--level", "--node", "--scale", "--link"}}}};
  auto& [with, options] = rules.at(job);
  if (job != Job::pack) options.insert(options.end(), of_packing.begin(), of_packing.end());
  if (job == Job::outer) options.push_back("--output");
  for (const char* const option : options)
    if (is_given(app, option))
      refuse_usage(std::string(option) + " does not go with " + with + ": leave it out");
}

void check_outputs(const Arguments& a, const CommonOptions& common, Job job) {
  std::vector<OutputFile> outputs;
  if (job != Job::robot) outputs.push_back({"--output", a.output, file::Kind::packing});
  outputs.push_back({"--report", a.report, std::nullopt, OutputForm::json});
  for (const std::string& path : a.exports) outputs.push_back({"--export", path, std::nullopt});
  outputs.push_back({"--view", a.view, std::nullopt, OutputForm::page});
  check_files({a.mesh, a.urdf, a.for_scene}, outputs, common);
}

void check(const CLI::App& app, const Arguments& a, const CommonOptions& common) {
  const Job job = job_of(a);
  const Repair repair = solid_options(a).repair;
  if (a.max_hole && repair != Repair::voxel && repair != Repair::flood)
    refuse_usage("--max-hole belongs to --repair voxel or flood");
  if (a.mesh.empty() && a.urdf.empty())
    refuse_usage(
        "no mesh is given: name an OBJ, OFF, PLY, STL, OM, COLLADA, glTF, 3MF or FBX file, or - "
        "for a pipe");
  if (!a.mesh.empty() && !a.urdf.empty())
    refuse_usage("--urdf takes the place of the mesh " + a.mesh + ": give one of them");
  check_options(app, job);
  if (a.output.empty() && a.exports.empty() && a.report.empty() && a.view.empty())
    refuse_usage("nothing would be written: give -o OUT.vpmp, --export, --report or --view");
  if (a.mesh == "-" && a.for_scene == "-")
    refuse_usage("only one of the mesh and --for-scene can be standard input");
  bool names_a_link = false;
  for (const std::string& path : a.exports) {
    const ExportFormat format = export_format(path);
    names_a_link = names_a_link || names_links(format);
    if (job != Job::robot) check_link(format, link_name(a));
  }
  if (!a.link.empty() && !names_a_link)
    refuse_usage(
        "--link is a name in .yml, .xrdf, .urdf and .srdf; give --export with one of these");
  check_outputs(a, common, job);
}

// Makes the solid; of a mesh that is refused, --view shows why.
CheckedSolid checked_solid(const Program& program, const Arguments& a, const RawMesh& mesh) {
  try {
    Progress progress("checking the mesh", program.common());
    return make_solid(mesh, solid_options(a), [&](double done) { progress.update(done); });
  } catch (const Error& fault) {
    if (!a.view.empty() && fault.kind() == ErrorKind::refused)
      write_defects_view(a.view, mesh, solid_options(a),
                         program.in_words_of_options(fault.problem()),
                         program.in_words_of_options(fault.hint()));
    throw;
  }
}

// Narrows the radii in `a` to those that the scene resolves, and returns its scale.
SceneScale fit_to_scene(const Program& program, const Solid& solid, Arguments& a) {
  const Scene scene(PointCloud::read(a.for_scene));
  const double size = bounding_radius(solid, mass_properties(solid).center_of_mass);
  const SceneScale scale = scene_scale(scene, size);
  a.min_radius = std::max(a.min_radius, scale.smallest_radius());
  const double largest = std::min(a.max_radius.value_or(HUGE_VAL), scale.largest_radius());
  if (std::isfinite(largest)) a.max_radius = largest;
  if (a.max_radius && *a.max_radius < a.min_radius) {
    refuse(a.for_scene + ": its points resolve spheres from " + std::to_string(a.min_radius) +
           " m, and --max-radius is smaller; allow larger ones, or scan more closely");
  }
  program.note("the scene asks for " + words_of(scale));
  return scale;
}

std::string why_none_fits(const Arguments& a, StopReason stop) {
  if (stop == StopReason::min_radius && !a.for_scene.empty())
    return "the points of " + a.for_scene + " resolve spheres from " +
           std::to_string(a.min_radius) + " m; are both in metres?";
  if (stop == StopReason::min_radius) return "give a smaller --min-radius";
  if (a.max_radius)
    return "spheres below 1/131072 of the solid's longest side are not searched for; give a larger "
           "--max-radius";
  return "the solid is nowhere wider than 1/131072 of its longest side, the smallest sphere that "
         "is searched for; pack it in parts";
}

PackResult pack_checked(const Program& program, const Arguments& a, const CheckedSolid& checked) {
  Progress progress("packing", program.common());
  PackOptions options;
  options.spheres = a.spheres;
  options.coverage = a.coverage;
  options.inertia_error = a.inertia_error.value_or(0);
  options.enclosure = &checked.enclosure;
  options.min_radius = a.min_radius;
  options.max_radius = a.max_radius.value_or(std::numeric_limits<double>::infinity());
  options.progress = [&](double fraction) { progress.update(fraction); };
  PackResult result = pack(checked.solid, options);
  if (result.spheres.empty()) refuse(a.mesh + ": no sphere fits: " + why_none_fits(a, result.stop));
  return result;
}

void grow_together(const Program& program, const Arguments& a, const CheckedSolid& checked,
                   PackResult& result) {
  Progress progress("growing", program.common());
  GrowOptions options;
  options.enclosure = &checked.enclosure;
  options.min_radius = a.min_radius;
  options.max_radius = a.max_radius.value_or(std::numeric_limits<double>::infinity());
  options.progress = [&](double fraction) { progress.update(fraction); };
  const double before = volume_of(result.spheres);
  result.spheres = grow(checked.solid, result.spheres, options);
  result.coverage *= volume_of(result.spheres) / before;
}

// Says why there are fewer spheres than asked for, or not the best ones.
void say_result(const Program& program, const Arguments& a, const PackResult& result) {
  const std::string count = std::to_string(result.spheres.size());
  const auto fewer = [&](const char* why) {
    program.note("packed " + count + " of the " + std::to_string(a.spheres) +
                 " spheres asked for: " + why);
  };
  if (result.stop == StopReason::min_radius)
    fewer("no further sphere of at least --min-radius fits");
  if (result.stop == StopReason::numerical_floor)
    fewer(
        "what is still empty is narrower than 1/131072 of the longest side, too narrow to search");
  if (result.partly_searched)
    program.note(
        "the solid has more narrow places than were searched, so some of the smallest spheres "
        "could "
        "be larger; a higher --spheres searches more");
}

// Says how much of a solid, whose box has these sides in metres, its spheres fill: the size shows a
// wrong unit, the coverage too few spheres. To be called once all files are written.
void say_summary(const Program& program, const PackResult& result, Vec3 sides) {
  const std::string count = std::to_string(result.spheres.size());
  const bool is_large = std::max({sides.x, sides.y, sides.z}) >= 1;
  const double unit = is_large ? 1 : 0.001;
  char text[200];
  std::snprintf(text, sizeof text, "%s %.3g %% of a solid of %.3g x %.3g x %.3g %s",
                (count + (result.spheres.size() == 1 ? " sphere fills" : " spheres fill")).c_str(),
                100 * result.coverage, sides.x / unit, sides.y / unit, sides.z / unit,
                is_large ? "m" : "mm");
  program.note(text);
}

void say_validation(const Program& program, const Validation& v, CheckedSolid& checked) {
  const std::string counts = std::to_string(v.protruding_voxels) + " voxels of spheres outside, " +
                             std::to_string(v.overlapping_voxels) + " of two spheres";
  // Disputed voxels are those where the two tests of the inside disagree; they prove no fault.
  if (v.protruding_voxels > v.disputed_voxels || v.overlapping_voxels > 0) {
    checked.warnings.push_back("the count of voxels contradicts the packing: " + counts +
                               "; check the mesh, which may intersect itself");
    program.warn(checked.warnings.back());
  } else {
    program.note("voxels: " + std::to_string(v.coverage) + " of the volume covered, " + counts);
  }
}

Packing make_packing(const Program& program, const std::string& input_hash, CheckedSolid checked,
                     std::vector<Sphere> spheres) {
  nlohmann::json parameters = program.parameters();
  for (const char* const name :
       {"validate", "link", "inflate", "level", "outer", "robot-spheres", "urdf", "package-path"})
    parameters.erase(name);  // no effect on it
  Packing packing;
  packing.spheres = std::move(spheres);
  packing.provenance.json() = {{"tool", program.name()},
                               {"version", VPM_VERSION},
                               {"parameters", parameters},
                               {"input_hash", input_hash},
                               {"solid_hash", content_hash(checked.solid)}};
  packing.solid = std::move(checked.solid);
  return packing;
}

void run(Program& program, Arguments a) {
  check(program.app(), a, program.common());
  if (job_of(a) == Job::robot) return run_robot(program, a);
  if (job_of(a) == Job::ready) return export_ready(program, a);
  if (!a.view.empty()) view::check_available();
  const auto start = std::chrono::steady_clock::now();
  const std::vector<std::byte> bytes = file::read_all(a.mesh);
  const std::string name = a.mesh == "-" ? "standard input" : a.mesh;
  CheckedSolid checked = checked_solid(program, a, parse_mesh(bytes, name, a.node));
  const std::string prefix = name + ": ";
  for (const std::string& note : checked.notes) program.note(prefix + note);
  for (const std::string& warning : checked.warnings) program.warn(prefix + warning);

  if (a.outer) return run_outer(program, a, checked);
  std::optional<SceneScale> scene;
  if (!a.for_scene.empty()) scene = fit_to_scene(program, checked.solid, a);
  PackResult result = pack_checked(program, a, checked);
  if (a.grow) grow_together(program, a, checked, result);
  const Certificate certificate = certify(checked.solid, result.spheres, &checked.enclosure);
  refuse_uncertified(a.mesh, result.coverage, certificate);
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  say_result(program, a, result);
  const Vec3 sides = checked.facts.high - checked.facts.low;

  std::optional<Validation> validation;
  if (a.validate) {
    validation = validate_packing(checked.solid, result.spheres);
    say_validation(program, *validation, checked);
  }
  if (!a.report.empty()) {
    auto report = pack_report(checked, result, certificate, validation, seconds);
    if (scene) report["scene"] = scene_report(*scene);
    file::write_all(a.report, report.dump(2) + "\n");
  }
  if (!a.view.empty()) write_packing_view(a.view, a.mesh, checked, result);
  write_exports(a, result.spheres);
  if (!a.output.empty()) {
    Packing packing =
        make_packing(program, file::content_hash({bytes}), std::move(checked), result.spheres);
    if (scene) packing.provenance.json()["scene"] = scene_report(*scene);
    write_packing(a.output, packing);
  }
  say_summary(program, result, sides);
}

}  // namespace

SolidOptions solid_options(const Arguments& a) {
  SolidOptions options{.weld = a.weld, .max_hole = a.max_hole};
  if (!a.scale_option->empty()) options.scale = a.scale;
  if (a.repair.empty() || parse_repair(a.repair, options)) return options;
  throw Error(
      ErrorKind::invalid_argument,
      "--repair: '" + a.repair + "' is none of holes, voxel, voxel=RES, flood and flood=RES");
}

std::vector<Sphere> inflated(const Arguments& a, std::vector<Sphere> spheres) {
  if (a.inflate == 0) return spheres;
  for (Sphere& s : spheres)
    s.radius = a.outer ? rounded_up(s.radius + a.inflate) : s.radius + a.inflate;
  return spheres;
}

void write_exports(const Arguments& a, const std::vector<Sphere>& spheres) {
  for (const std::string& path : a.exports)
    export_packing(path, inflated(a, spheres), link_name(a));
}

// Does what the command line, or a configuration, says. Returns the exit status.
int run_program(int argc, char** argv) {
  Program program("vpm-pack", "Fill a closed mesh with spheres that neither overlap nor protrude");
  Arguments arguments;
  ListArguments list;
  declare(program.app(), arguments);
  declare_list(program.app(), list);
  program.show_examples({
      "vpm-pack tool.off -o tool.vpmp --spheres 1000",
      "vpm-pack tool.off --spheres 50 --grow --export tool.yml --link gripper   # for cuRobo",
      "vpm-pack tool.off -o open.vpmp --scale 0.001 --repair voxel   # millimetres, open",
  });
  std::string holes = "--repair=holes";
  std::vector<char*> words = with_plain_repair(argc, argv, holes);
  return program.run(argc, words.data(), [&] {
    if (!run_list(program, list, {"mesh", ".vpmp"})) run(program, arguments);
  });
}

}  // namespace vpm::tools

int main(int argc, char** argv) {
  return vpm::tools::run_or_work(argc, argv, vpm::tools::run_program);
}
