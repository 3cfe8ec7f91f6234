// What all executables share: common options, JSON configurations, exit codes, messages, progress.
#pragma once

#include <CLI/CLI.hpp>
#include <chrono>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "libvpm/device/device.h"
#include "libvpm/file/container.h"

namespace vpm::tools {

struct CommonOptions {
  std::string device = "auto";  // auto, cpu, cuda, cuda:N, cuda:all
  int threads = 0;              // 0: one per core
  bool quiet = false;
  bool verbose = false;
  bool force = false;
};

class Tool {
 public:
  // `name` is the executable's, `purpose` its first line of help.
  Tool(const std::string& name, const std::string& purpose);

  CLI::App& app() { return app_; }
  const CommonOptions& common() const { return common_; }
  const std::string& name() const { return name_; }

  // To be called before run() by a tool that asks for device(). Others refuse --device cuda.
  void computes_on_devices() { on_devices_ = true; }
  // The device of --device. Throws Error(unavailable) where it is not there.
  Device device() const { return device_from_text(common_.device); }

  // Parses, then runs `job`; turns every error into a message on standard error and an exit code.
  int run(int argc, char** argv, const std::function<void()>& job);

  // "vpm-pack: note: ..." on standard error unless --quiet.
  void note(const std::string& text) const;
  void warn(const std::string& text) const;    // also with --quiet
  void detail(const std::string& text) const;  // only with --verbose

  // The options as parsed, for the provenance of an output: no names of files (what was in them
  // counts, so say its hash), nothing that changes no result.
  nlohmann::json parameters() const;

 private:
  void refuse_empty_values() const;

  std::string name_;
  CLI::App app_;
  CommonOptions common_;
  bool dump_config_ = false;
  bool on_devices_ = false;
};

// An output: the option that names it, and the container that it becomes, if any.
struct OutputFile {
  const char* option;
  std::string path;
  std::optional<file::Kind> kind;
};

// To be called before the work begins. Refuses two outputs in one place. Without --force a
// container replaces only one of its kind, another output (report, table, mesh) anything but a
// container (libvpm/file/overwrite.h), and none of them an input.
void check_files(const std::vector<std::string>& inputs, const std::vector<OutputFile>& outputs,
                 const CommonOptions& common);

// Shows a line of progress and the time it may still take on standard error, if that is a terminal
// and --quiet is not given.
class Progress {
 public:
  Progress(std::string what, const CommonOptions& common);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  void update(double fraction);  // 0..1; thread-safe is not promised

 private:
  std::string what_;
  bool shown_;
  int percent_ = -1;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace vpm::tools
