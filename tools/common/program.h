// Base of all executables: common options, JSON configurations, exit codes, messages, progress.
#pragma once

#include <vpm/device.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "libvpm/file/kind.h"
#include "tools/common/help.h"

namespace vpm::tools {

struct CommonOptions {
  std::string device = "auto";  // auto, cpu, cuda, cuda:N, cuda:all
  int threads = 0;              // 0: one per core
  bool quiet = false;
  bool verbose = false;
  bool force = false;
};

class Program {
 public:
  // Adds the common options. `name` is the executable's name, `purpose` the first line of its help.
  Program(const std::string& name, const std::string& purpose);
  ~Program();  // compiled once, for it takes half of CLI11

  CLI::App& app() { return app_; }
  const CommonOptions& common() const { return common_; }
  const std::string& name() const { return name_; }

  // Accepts --device cuda, which is refused otherwise. To be called before run() if the program
  // asks for device().
  void computes_on_devices() { on_devices_ = true; }
  bool can_use_devices() const { return on_devices_; }
  // Returns the device that --device names. Throws Error(unavailable) if this machine lacks it.
  Device device() const { return device_from_text(common_.device); }

  // Ends both helps with these commands, which use the files of the pages' examples.
  void show_examples(std::vector<std::string> commands) {
    help_->set_examples(std::move(commands));
  }
  // Tells both helps of an exit code beyond those of all programs.
  void show_exit_code(int code, std::string meaning) {
    help_->add_exit_code(code, std::move(meaning));
  }
  // Lets no message name these options from now on, since they do not go with what is asked: it
  // names the program that has them.
  void name_no_more(std::vector<std::string> options) { not_named_ = std::move(options); }
  // Lets run() return this where the job does not fail, in place of 0: the answer to a question of
  // a script.
  void end_with(int code) { answer_ = code; }

  // Parses the command line and runs `job`. Turns every error into a message on standard error and
  // returns the exit code.
  int run(int argc, char** argv, const std::function<void()>& job);

  // Prints "vpm-pack: note: ..." to standard error unless --quiet is given.
  void note(const std::string& text) const;
  // Prints "vpm-pack: warning: ..." to standard error, with --quiet too.
  void warn(const std::string& text) const;
  // Prints "vpm-pack: error: ..." to standard error, of an input without which the job goes on.
  void error(const std::string& text) const;
  // Prints "vpm-pack: ..." to standard error with --verbose only.
  void detail(const std::string& text) const;

  // Returns the text with options for the names in backquotes.
  std::string in_words_of_options(const std::string& text) const;

  // Returns the options as parsed, for the provenance of an output. Leaves out file names, since
  // provenance names inputs by their hash, and options that never change a result.
  nlohmann::json parameters() const;
  // Returns the options that are given, as JSON for --config.
  std::string configuration() const;

 private:
  bool parse(int argc, char** argv);
  std::string config_name() const;
  void show_page() const;
  void declare_common();
  void declare_configurations();
  void refuse_values_of_flags(int argc, char** argv) const;
  void refuse_senseless_values() const;
  void print(const char* kind, const std::string& text) const;

  std::string name_;
  CLI::App app_;
  std::shared_ptr<Help> help_ = std::make_shared<Help>();
  CommonOptions common_;
  bool dump_config_ = false;
  bool on_devices_ = false;
  std::vector<std::string> not_named_;
  int answer_ = 0;
};

// Returns the names whose values differ in two objects of options, with commas; empty if all are
// alike.
std::string differences(const nlohmann::json& a, const nlohmann::json& b);

// What a file holds that is no container: what its name's ending says, JSON, lines of results (JSON
// or CSV), or a page.
enum class OutputForm { by_name, json, results, page };

// An output file: the option that names it, its path, and its container kind where it has one.
struct OutputFile {
  const char* option;
  std::string path;
  std::optional<file::Kind> kind;
  OutputForm form = OutputForm::by_name;
};

// Throws Error(invalid_argument) if two outputs would be one file, or an output an input, and
// without --force if an output is there already or its name ends like that of another kind
// (libvpm/file/overwrite.h). To be called before the work begins.
void check_files(const std::vector<std::string>& inputs, const std::vector<OutputFile>& outputs,
                 const CommonOptions& common);

// Shows a line of progress and an estimate of the time left on standard error, if that is a
// terminal and --quiet is not given.
class Progress {
 public:
  Progress(std::string what, const CommonOptions& common);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  // Shows `fraction` of the work as done, 0 to 1. Not thread-safe.
  void update(double fraction);

 private:
  std::string what_;
  bool shown_;
  int percent_ = -1;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace vpm::tools
