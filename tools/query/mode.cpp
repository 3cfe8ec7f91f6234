#include "tools/query/mode.h"

#include <array>

#include "tools/common/error_text.h"
#include "tools/common/given_options.h"

namespace vpm::tools {
namespace {

enum Cell : unsigned char {
  no,
  yes,
  either,  // one of the options that the column marks so is required
  scene,   // one or more of the options that the column marks so are required
  required
};

struct Row {
  const char* option;
  std::array<Cell, kModes> in_mode;
  const char* advice = "";  // follows "--option is missing: "
};

// Options that are not in this table go with all modes.
constexpr Row kTable[] = {
    // poses, batches, coupling, frames, several tools, several tools in frames,
    // server, pairs, robot; what is left out at the end is `no`
    {"--tool",
     {required, required, required, required, required, required, required, no},
     "give the .vpmg that vpm-graph wrote"},
    {"--cloud",
     {scene, scene, scene, no, scene, no, yes, no, yes},
     "give the .vpmc that vpm-normals wrote, or --solid or --frames"},
    {"--register", {yes, yes, yes, yes, yes, yes, yes, no, yes}},
    {"--solid", {scene, scene, scene, yes, scene, yes, yes, no, yes}},
    {"--bodies", {yes, yes, no, no, no, no, no, no}},
    {"--contacts", {yes, yes, no, yes, yes, yes, yes, yes, yes}},
    {"--interval", {yes, yes, no, yes, yes, yes, yes, no, yes}},
    {"--pose", {either, either, no, no, either, no, no, no, yes}},
    {"--poses",
     {either, either, required, required, either, required, no, yes},
     "give the path of the haptic device, or with --frames the path of the "
     "tool"},
    {"--batch", {yes, yes, no, no, yes, no, no, no}},
    {"--coupling", {yes, no, yes, yes, no, no, no, no}},
    {"--deadline-us", {yes, no, yes, yes, no, no, yes, no}},
    {"--coherent", {yes, no, yes, yes, no, no, yes, no}},
    {"--collides", {yes, yes, no, yes, yes, yes, yes, no}},
    {"--fail-above", {yes, yes, no, yes, yes, yes, yes, yes, yes}},
    {"--collides-only", {yes, no, no, no, no, no, no, no}},
    {"--unseen", {yes, yes, no, yes, yes, yes, yes, no}},
    {"--spheres-out", {yes, yes, yes, yes, no, no, no, no}},
    {"--frames", {no, no, no, yes, no, yes, no, no}},
    {"--topic", {no, no, no, yes, no, yes, no, no}},
    {"--rate", {no, no, no, yes, no, yes, no, no}},
    {"--camera-poses", {no, no, no, yes, no, yes, no, no}},
    {"--remove", {no, no, no, yes, no, yes, no, no}},
    {"--remove-margin", {no, no, no, yes, no, yes, no, no}},
    {"--frame-rate", {no, no, no, yes, no, yes, no, no}},
    {"--frame-latency", {no, no, no, yes, no, yes, no, no}},
    {"--align-starts", {no, no, no, yes, no, yes, no, no}},
    {"--repeat-frames", {no, no, no, yes, no, yes, no, no}},
    {"--realtime", {no, no, no, yes, no, yes, no, no}},
    {"--intrinsics", {no, no, no, yes, no, yes, yes, no}},
    {"--camera-pose", {no, no, no, yes, no, yes, yes, no}},
    {"--view", {yes, yes, yes, yes, yes, yes, no, no, yes}},
    {"--resume", {yes, yes, yes, yes, yes, yes, no, no, yes}},
    {"--serve", {no, no, no, no, no, no, yes, no}},
    {"--measure", {yes, yes, yes, yes, yes, yes, yes, no, yes}},
    {"--stiffness", {yes, yes, yes, yes, yes, yes, yes, no, yes}},
    {"--shadows", {yes, yes, yes, yes, yes, yes, yes, no, yes}},
    {"--raw-points", {yes, yes, yes, yes, yes, yes, yes, no, yes}},
    {"--level", {yes, yes, yes, yes, yes, yes, yes, no}},
    {"--max-error", {yes, yes, yes, yes, yes, yes, yes, no}},
    {"--for-scene", {yes, yes, yes, yes, yes, yes, yes, no}},
    {"--stats", {yes, yes, yes, yes, yes, yes, yes, no}},
    {"--pairs", {no, no, no, no, no, no, no, yes}},
    {"--urdf", {no, no, no, no, no, no, no, no, yes}},
    {"--joints",
     {no, no, no, no, no, no, no, no, required},
     "give configurations of the robot, a line of JSON each"},
    {"--srdf", {no, no, no, no, no, no, no, no, yes}},
    {"--package-path", {no, no, no, no, no, no, no, no, yes}},
    {"--unit", {no, no, no, no, no, no, no, yes}},
    {"--repair", {no, no, no, no, no, no, no, yes}},
};

struct Pair {
  const char* first;
  const char* second;
};

constexpr Pair kExclusive[] = {
    {"--pose", "--poses"},
    {"--level", "--max-error"},
    {"--level", "--for-scene"},
    {"--max-error", "--for-scene"},
    {"--level", "--deadline-us"},
    {"--coherent", "--deadline-us"},
    {"--camera-pose", "--camera-poses"},
    {"--resume", "--deadline-us"},
    {"--resume", "--spheres-out"},
    {"--resume", "--view"},
    {"--resume", "--collides"},
    {"--resume", "--fail-above"},
    {"--collides", "--coupling"},
    {"--fail-above", "--coupling"},
    {"--contacts", "--coupling"},
    {"--interval", "--coupling"},
    {"--collides-only", "--resume"},
    {"--collides-only", "--bodies"},
    {"--collides-only", "--contacts"},
    {"--collides-only", "--interval"},
    {"--collides-only", "--spheres-out"},
    {"--collides-only", "--view"},
    {"--collides-only", "--fail-above"},
};

struct Need {
  const char* option;
  const char* needed;
  const char* advice;  // follows "--option needs --needed: "
};

constexpr Need kNeeds[] = {
    {"--coupling", "--stiffness", "give the scene's stiffness in N/m^3"},
    {"--resume", "--output", "name the file of the run that was interrupted"},
    {"--unseen", "--collides", "it says when that is unknown"},
    {"--remove-margin", "--remove", "it names the solids and their poses"},
};

struct Words {
  const char* mode;
  const char* choice;  // tells which options choose the mode
};

constexpr Words kWords[kModes] = {
    {"poses in a cloud", "chosen because --frames is not given"},
    {"poses in batches", "chosen by --batch"},
    {"a haptic device's path in a cloud", "chosen by --coupling without --frames"},
    {"recorded frames", "chosen by --frames"},
    {"several tools in a cloud", "chosen by more than one --tool"},
    {"several tools in recorded frames", "chosen by --frames and more than one --tool"},
    {"requests", "chosen by --serve"},
    {"pairs of an assembly", "chosen by --pairs"},
    {"a robot", "chosen by --urdf"},
};

// True if an option that says the same is given.
bool is_told_by_another(const CLI::App& app, const std::string& name) {
  return name == "--collides" && is_given(app, "--collides-only");
}

// Returns the items as "a, b and c" if `last` is "and".
std::string list_of(const std::vector<std::string>& items, const std::string& last) {
  std::string list;
  for (std::size_t k = 0; k < items.size(); ++k) {
    if (k > 0) list += k + 1 < items.size() ? ", " : " " + last + " ";
    list += items[k];
  }
  return list;
}

void refuse_options_of_other_modes(const CLI::App& app, Mode mode) {
  const std::size_t column = static_cast<std::size_t>(mode);
  std::vector<std::string> misplaced;
  for (const Row& row : kTable)
    if (row.in_mode[column] == no && is_given(app, row.option)) misplaced.push_back(row.option);
  if (misplaced.empty()) return;
  const bool is_one = misplaced.size() == 1;
  refuse_usage(list_of(misplaced, "and") + (is_one ? " does" : " do") + " not go with " +
               kWords[column].mode + ", " + kWords[column].choice + ": leave " +
               (is_one ? "it" : "them") + " out");
}

void refuse_missing_options(const CLI::App& app, Mode mode) {
  const std::size_t column = static_cast<std::size_t>(mode);
  std::vector<std::string> alternatives;
  bool has_one = false;
  const bool has_scene = is_given(app, "--cloud") || is_given(app, "--solid");
  for (const Row& row : kTable) {
    const bool given = is_given(app, row.option) || (row.in_mode[column] == scene && has_scene);
    if ((row.in_mode[column] == required || row.in_mode[column] == scene) && !given)
      refuse_usage(std::string(row.option) + " is missing: " + row.advice);
    if (row.in_mode[column] != either) continue;
    alternatives.push_back(row.option);
    has_one = has_one || given;
  }
  if (!alternatives.empty() && !has_one)
    refuse_usage(list_of(alternatives, "or") + " is missing: give one of them");
}

// Throws Error(invalid_argument) unless there is one file of poses, or in
// frames one for each tool.
void check_paths(const CLI::App& app, Mode mode) {
  const std::size_t paths = app.get_option("--poses")->count();
  const std::size_t tools = app.get_option("--tool")->count();
  if (paths <= 1 || (mode == Mode::tools_in_frames && paths == tools)) return;
  if (mode == Mode::tools_in_frames)
    refuse_usage("--poses is given " + std::to_string(paths) + " times and --tool " +
                 std::to_string(tools) + " times: give one path for all tools, or one for each");
  refuse_usage(
      "--poses has several values; leave all but one out: only "
      "several --tool with --frames have a "
      "path each");
}

}  // namespace

Mode mode_of(const Arguments& a) {
  if (!a.pairs.empty()) return Mode::pairs;
  if (!a.urdf.empty()) return Mode::robot;
  if (a.serve) return Mode::server;
  const bool are_several = a.tools.size() > 1;
  if (!a.replay.frames.empty()) return are_several ? Mode::tools_in_frames : Mode::frames;
  if (are_several) return Mode::several_tools;
  if (!a.coupling.empty()) return Mode::coupling;
  if (a.batch > 1) return Mode::batches;
  return Mode::poses;
}

void check_options(const CLI::App& app, Mode mode) {
  refuse_options_of_other_modes(app, mode);
  for (const auto& [first, second] : kExclusive)
    if (is_given(app, first) && is_given(app, second))
      refuse_usage(std::string(first) + " and " + second +
                   " exclude each other: leave one of them out");
  if (mode == Mode::server && app.get_option("--tool")->count() > 1)
    refuse_usage("--serve answers for one tool: give one --tool");
  refuse_missing_options(app, mode);
  check_paths(app, mode);
  for (const auto& [option, needed, advice] : kNeeds)
    if (is_given(app, option) && !is_given(app, needed) && !is_told_by_another(app, needed))
      refuse_usage(std::string(option) + " needs " + needed + ": " + advice);
}

}  // namespace vpm::tools
