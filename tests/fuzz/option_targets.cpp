#include <csignal>
#include <iostream>
#include <sstream>

#include "libvpm/cloud/normals.h"
#include "libvpm/core/error.h"
#include "libvpm/device/device.h"
#include "libvpm/import/depth_values.h"
#include "tests/fuzz/targets.h"
#include "tools/common/import_arguments.h"
#include "tools/common/json_config.h"
#include "tools/common/number_checks.h"
#include "tools/common/program.h"
#ifdef VPM_FUZZ_SOLID
#include "tools/common/repair_option.h"
#endif

namespace vpm::fuzz {
namespace {

// Diverts std::cerr or std::cout while it lives.
class Diverted {
 public:
  explicit Diverted(std::ostream& stream) : stream_(stream), usual_(stream.rdbuf(text_.rdbuf())) {}
  ~Diverted() { stream_.rdbuf(usual_); }
  Diverted(const Diverted&) = delete;
  Diverted& operator=(const Diverted&) = delete;

  std::string text() const { return text_.str(); }

 private:
  std::ostringstream text_;
  std::ostream& stream_;
  std::streambuf* usual_;
};

// Options of every kind that the tools have.
struct Options {
  std::string input, output, repair;
  std::size_t spheres = 5;
  double coverage = 1;
  std::optional<double> weld;
  bool grow = false;
  std::vector<std::uint32_t> levels;
  std::vector<std::string> tools;
  tools::ImportArguments import;

  void declare(CLI::App& app) {
    constexpr long long kMostSpheres = 0xfffffffe;
    app.add_option("input", input, "Input");
    app.add_option("-o,--output", output, "Output");
    app.add_option("--spheres", spheres, "Number")
        ->check(tools::whole_number_in(1, kMostSpheres))
        ->capture_default_str();
    app.add_option("--coverage", coverage, "Fraction")->capture_default_str();
    app.add_option("--weld", weld, "Length")->check(tools::positive_number());
    app.add_flag("--grow", grow, "Flag");
    app.add_option("--repair", repair, "Word")->expected(0, 1)->default_str("holes");
    app.add_option("--levels", levels, "List")->delimiter(',');
    app.add_option("--tool", tools, "List");
    tools::declare(app, import);
  }
};

void restore_signals() {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, SIG_DFL);
}

// Reads the JSON alone.
void read_config(Bytes input) {
  std::istringstream text(text_of(input));
  try {
    tools::JsonConfig().from_config(text);
  } catch (const CLI::Error& fault) {
    if (std::string_view(fault.what()).empty()) fail("no message");
  }
}

// Runs a program that has all options.
void run_tool(Bytes input) {
  int code = -1;
  std::string said, foreign;
  {
    const Diverted errors(std::cerr), output(std::cout);
    tools::Program program("vpm-fuzz", "Reads a configuration");
    Options options;
    options.declare(program.app());
    std::string config = "--config=" + path_of(input), name = "vpm-fuzz";
    char* arguments[] = {name.data(), config.data(), nullptr};
    code = program.run(2, arguments, [&] {
      try {
        tools::import_options(program, options.import);
        program.parameters();
      } catch (const Error&) {
        throw;
      } catch (const std::exception& fault) {
        foreign = fault.what();
        throw;
      }
    });
    said = errors.text();
  }
  restore_signals();
  if (!foreign.empty()) fail("a foreign exception: " + foreign);
  if (code < 0 || code > 3) fail("exit code " + std::to_string(code));
  if (code != 0 && said.empty()) fail("no message");
  if (said.find("[json.") != said.npos) fail("a library's message: " + said);
}

}  // namespace

void run_config(Bytes input) {
  constexpr std::size_t kRunOf = 32;  // configurations of which one is given to a program
  if (Choice(input).one_of(kRunOf) == 0)
    run_tool(input);
  else
    read_config(input);
}

void run_options(Bytes input) {
  if (input.empty()) return;
  const std::string text = text_of(input.subspan(1));
  constexpr double kHigh = 1 << 20;
  expect_error_at_most([&] {
    switch (static_cast<unsigned>(input[0]) % 9) {
      case 0:
        return expect_finite(pose_from_text(text));
      case 1:
        tools::fraction_from_text(text, "--option");
        return;
      case 2:
        device_from_text(text);
        return;
      case 3:
        normal_method_from_text(text);
        return;
      case 4:
        decoding_from_text(text);
        return;
      case 5:
        tools::positive_number()(text);
        return;
      case 6:
        tools::number_in(0, kHigh)(text);
        return;
      case 7:
        tools::whole_number_in(0, 1 << 20)(text);
        return;
      default: {
#ifdef VPM_FUZZ_SOLID
        SolidOptions options;
        tools::parse_repair(text, options);
#endif
        return;
      }
    }
  });
}

}  // namespace vpm::fuzz
