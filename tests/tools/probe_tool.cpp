// A tool with an option of every type, to test what all tools share.
#include <unistd.h>

#include <csignal>
#include <iostream>

#include "libvpm/core/error.h"
#include "libvpm/file/stream.h"
#include "tools/common/program.h"

int main(int argc, char** argv) {
  vpm::tools::Program program("vpm-probe", "Tests what the tools share");
  std::string input, output, text = "none", act = "nothing";
  int count = 3;
  double factor = 0.1;
  std::vector<int> levels;
  bool flag = false;
  program.app().add_option("input", input, "A positional argument")->required();
  program.app().add_option("-o,--output", output, "An output")->required();
  program.app().add_option("--text", text, "Text")->capture_default_str();
  program.app().add_option("--count", count, "A whole number")->capture_default_str();
  program.app().add_option("--factor", factor, "A number")->capture_default_str();
  program.app().add_option("--levels", levels, "A list")->delimiter(',');
  program.app().add_flag("--flag", flag, "A flag");
  program.app().add_option("--act", act, "What to do")->capture_default_str();
  return program.run(argc, argv, [&] {
    vpm::tools::check_files({input}, {{"--output", output, std::nullopt}}, program.common());
    if (act == "refuse") vpm::refuse("input.off: refused as asked");
    if (act == "usage") throw vpm::Error(vpm::ErrorKind::invalid_argument, "wrong as asked");
    if (act == "unavailable") throw vpm::Error(vpm::ErrorKind::unavailable, "not there as asked");
    if (act == "throw") throw std::runtime_error("thrown as asked");
    if (act == "exhaust") throw std::bad_alloc();
    if (act == "parameters") std::cout << program.parameters().dump() << '\n';
    if (act == "say") {
      program.note("a note");
      program.warn("a warning");
      program.detail("a detail");
    }
    const std::string list = nlohmann::json(levels).dump();
    vpm::file::write_all(output, input + " " + text + " " + std::to_string(count) + " " +
                                     std::to_string(factor) + " " + list + (flag ? " flag" : "") +
                                     "\n");
  });
}
