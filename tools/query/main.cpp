// vpm-query: how much of the tool is inside the cloud's solid, and what pushes it out.

#include "tools/query/arguments.h"
#include "tools/query/mode.h"

namespace vpm::tools {
namespace {

void run(Tool& tool, const Arguments& arguments) {
  const Mode mode = mode_of(arguments);
  check_options(tool.app(), mode);
  check_names(arguments, tool.common());
  QuerySetup setup(tool, arguments);
  switch (mode) {
    case Mode::poses:
    case Mode::batches:
      return run_poses(setup);
    case Mode::coupling:
      return run_coupling(setup);
    case Mode::frames:
      return run_frames(setup);
    case Mode::several_tools:
      return run_several_tools(setup);
  }
}

}  // namespace
}  // namespace vpm::tools

int main(int argc, char** argv) {
  using namespace vpm::tools;
  Tool tool("vpm-query", "Penetration volume, force and torque of a tool in a point cloud");
  Arguments arguments;
  declare(tool.app(), arguments);
  tool.computes_on_devices();
  return tool.run(argc, argv, [&] { run(tool, arguments); });
}
