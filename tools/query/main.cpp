// vpm-query: how much of the tool is inside the cloud's solid, and what pushes it out; which parts
// of an assembly share volume.

#include <ios>
#include <string>

#include "tools/common/list_run.h"
#include "tools/common/list_worker.h"
#include "tools/query/arguments.h"
#include "tools/query/kept_lines.h"
#include "tools/query/mode.h"
#include "tools/query/pairs.h"

namespace vpm::tools {
namespace {

void run(Program& program, const Arguments& arguments) {
  const Mode mode = mode_of(arguments);
  check_options(program.app(), mode);
  if (!program.common().force &&
      KeptLines::are_finished(arguments.output, leftover_of(arguments, program.common())))
    return program.note("nothing is left to do, since the run of " + arguments.output +
                        " has ended; --force makes it anew");
  check_names(arguments, program.common());
  if (mode == Mode::pairs) return run_pairs(program, arguments);
  program.name_no_more({"--unit", "--repair"});
  if (mode == Mode::robot) return run_robot(program, arguments);
  QuerySetup setup(program, arguments);
  switch (mode) {
    case Mode::poses:
    case Mode::batches:
      run_poses(setup);
      break;
    case Mode::coupling:
      run_coupling(setup);
      break;
    case Mode::frames:
    case Mode::tools_in_frames:
      run_frames(setup);
      break;
    case Mode::several_tools:
      run_several_tools(setup);
      break;
    case Mode::server:
      run_server(setup);
      break;
    case Mode::pairs:  // these have no tool of a file, hence no setup
    case Mode::robot:
      break;
  }
  if (mode == Mode::server) return;
  for (const std::string& text : setup.collisions.above()) program.note(text);
  program.end_with(setup.collisions.exit_code());
}

// Does what the command line, or a configuration, says. Returns the exit status.
int run_program(int argc, char** argv) {
  Program program("vpm-query", "Penetration volume, force and torque of a tool in a point cloud");
  Arguments arguments;
  ListArguments list;
  declare(program.app(), arguments);
  declare_list(program.app(), list);
  program.show_exit_code(
      10, "with --collides: at a pose there is a collision; with --fail-above: a volume above it");
  program.show_exit_code(11, "the same: at none there is one, but at some nobody can know");
  program.show_examples({
      "vpm-query --tool tool.vpmg --cloud scene.vpmc --pose 0,0,0.9,0,0,0,1",
      "vpm-query --tool tool.off --cloud scene.vpmc --poses poses.jsonl -o results.csv",
      "vpm-query --tool tool.vpmg --frames clouds --poses path.txt -o steps.jsonl",
  });
  program.computes_on_devices();
  return program.run(argc, argv, [&] {
    if (!run_list(program, list, {"cloud", ".jsonl"})) run(program, arguments);
  });
}

}  // namespace
}  // namespace vpm::tools

int main(int argc, char** argv) {
  std::ios::sync_with_stdio(false);  // so that standard input is read in blocks
  return vpm::tools::run_or_work(argc, argv, vpm::tools::run_program);
}
