#include "tools/common/program.h"

#include <fcntl.h>
#include <unistd.h>
#include <vpm/version.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <iostream>
#include <memory>
#include <new>
#include <utility>
#include <vector>

#include "libvpm/core/error.h"
#include "libvpm/file/overwrite.h"
#include "libvpm/file/stream.h"
#include "tools/common/early_failure.h"
#include "tools/common/error_text.h"
#include "tools/common/json_config.h"
#include "tools/common/number_checks.h"
#include "tools/common/parse_message.h"

namespace vpm::tools {
namespace {

// Removes unfinished output, then lets the signal end the process as its caller expects.
extern "C" void clean_up_and_die(int signal) {
  file::remove_unfinished_output();
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

constexpr std::size_t kLongestMessage = 2000;  // bytes

// True if the parent lets processes die of a closed pipe, as shells do.
bool dies_of_closed_pipes = true;

void set_signals() {
  // Makes a closed pipe and a file beyond its size limit failed writes, so that outputs are cleaned
  // up.
  dies_of_closed_pipes = std::signal(SIGPIPE, SIG_IGN) != SIG_IGN;
  std::signal(SIGXFSZ, SIG_IGN);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    // Keeps signals ignored that nohup or the shell of a background job has set so.
    if (std::signal(signal, clean_up_and_die) == SIG_IGN) std::signal(signal, SIG_IGN);
  }
}

// Seconds before the time left is shown; earlier estimates jump about.
constexpr double kSecondsToEstimate = 2;

bool is_asked(int argc, char** argv, const std::string& flag) {
  return std::find(argv, argv + argc, flag) != argv + argc;
}

// Opens /dev/null in place of closed standard streams, the wrong way round so that using them
// fails. Otherwise an output file could get the number of standard error and be mixed with notes.
void open_standard_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (::fcntl(stream, F_GETFD) != -1 || errno != EBADF) continue;
    // open() takes the lowest free number, which is `stream`.
    if (::open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY) != stream) return;
  }
}

constexpr const char* kEmptyValue = "its value is empty; give one, or leave the option out";

// Refuses "--report=" with an empty value (a script's unset variable); CLI11 would take the next
// argument for the value.
void refuse_cut_options(int argc, char** argv) {
  for (int k = 1; k < argc; ++k) {
    const std::string_view argument = argv[k];
    if (argument.starts_with("--") && argument.find('=') == argument.size() - 1)
      throw CLI::ValidationError(std::string(argument.substr(0, argument.size() - 1)), kEmptyValue);
  }
}

void flush_output() {
  errno = 0;
  if (std::cout.flush()) return;
  if (errno == EPIPE) throw file::ClosedPipe("cannot write to standard output: Broken pipe");
  throw Error(ErrorKind::cannot_write, "cannot write to standard output");
}

// Ends the process as a closed pipe ends others: without a message, by the signal.
void die_of_closed_pipe() {
  std::signal(SIGPIPE, SIG_DFL);
  std::raise(SIGPIPE);
}

std::string check_device(const std::string& text) {
  const bool has_index = text.rfind("cuda:", 0) == 0 && text.size() > 5 &&
                         text.find_first_not_of("0123456789", 5) == std::string::npos;
  if (has_index || text == "auto" || text == "cpu" || text == "cuda" || text == "cuda:all")
    return {};
  return text + " not in {auto,cpu,cuda,cuda:N,cuda:all}";
}

}  // namespace

Program::Program(const std::string& name, const std::string& purpose)
    : name_(name), app_(purpose, name) {
  app_.formatter(help_);
  declare_common();
  declare_configurations();
  begin_group(app_, "Options");
}

Program::~Program() = default;

void Program::declare_common() {
  begin_group(app_, kCommonGroup);
  app_.add_option("--device", common_.device,
                  "Where to compute; auto is cuda where there is a device. Never changes a result")
      ->option_text("auto|cpu|cuda|cuda:N|cuda:all")
      ->check(check_device)
      ->capture_default_str();
  app_.add_option("--threads", common_.threads,
                  "Use this many threads; 0 is one per core. Never changes a result")
      ->check(whole_number_in(0, 4096))
      ->capture_default_str();
  app_.add_flag("--force", common_.force, "Overwrite outputs whatever they are now, even inputs");
  app_.add_flag("--quiet", common_.quiet,
                "Print no notes and no progress; warnings and errors are still printed");
  app_.set_help_flag("-h,--help", "Print what is used most, and stop");
  app_.set_help_all_flag("--help-all", "Print all options, and stop");
}

void Program::declare_configurations() {
  begin_group(app_, kConfigGroup, Group::rare);
  app_.set_version_flag("--version", name_ + " " VPM_VERSION, "Print the version, and stop");
  app_.config_formatter(std::make_shared<JsonConfig>());
  app_.set_config("--config", "", "Read options from a JSON file; the command line wins")
      ->option_text("FILE")
      ->transform([](const std::string& path) { return path == "-" ? "/dev/stdin" : path; });
  app_.allow_config_extras(false);
  app_.add_flag("--dump-config", dump_config_, "Print the options as JSON for --config, and stop")
      ->configurable(false);
  app_.add_flag("--verbose", common_.verbose, "Say more about what is done");
}

// Reads the command line. False if it asked for the configuration, which is printed then.
bool Program::parse(int argc, char** argv) {
  // Lets --dump-config pass without required options: inputs may not be known yet.
  if (is_asked(argc, argv, "--dump-config")) {
    for (CLI::Option* option : app_.get_options()) option->required(false);
  }
  refuse_cut_options(argc, argv);
  refuse_values_of_flags(argc, argv);
  app_.parse(argc, argv);
  refuse_senseless_values();
  if (dump_config_) {
    std::cout << app_.config_to_str(true, false);
    flush_output();
    return false;
  }
  if (common_.device != "auto" && device().is_cuda() && !on_devices_) {
    throw Error(ErrorKind::unavailable,
                "--device " + common_.device + ": " + name_ +
                    " computes on the CPU only; use --device cpu, or leave the option out");
  }
  return true;
}

int Program::run(int argc, char** argv, const std::function<void()>& job) {
  end_of_early_failures();
  if (!on_devices_)
    app_.get_option("--device")
        ->option_text("auto|cpu")
        ->description(name_ + " computes on the CPU only");
  open_standard_streams();
  set_signals();
  const auto fail = [&](ErrorKind kind, const std::string& message) {
    std::cerr << name_ << ": error: " << printable(message, kLongestMessage) << '\n';
    return exit_code(kind);
  };
  try {
    if (!parse(argc, argv)) return 0;
    set_thread_count(common_.threads);
    job();
    flush_output();
    show_page();
    return answer_;
  } catch (const CLI::Success& asked) {  // --help, --version
    const int code = app_.exit(asked);
    errno = 0;
    if (std::cout.flush()) return code;
    if (errno == EPIPE && dies_of_closed_pipes) die_of_closed_pipe();
    return fail(ErrorKind::cannot_write, "cannot write to standard output");
  } catch (const CLI::ParseError& fault) {
    return fail(
        ErrorKind::invalid_argument,
        message_of(app_, fault, config_name(), std::span(argv, static_cast<std::size_t>(argc))) +
            " (see " + name_ + " --help)");
  } catch (const file::ClosedPipe& fault) {
    if (dies_of_closed_pipes) die_of_closed_pipe();
    return fail(fault.kind(), fault.what());
  } catch (const Error& fault) {
    return fail(fault.kind(), in_words_of_options(fault.what()));
  } catch (const std::bad_alloc&) {
    return fail(ErrorKind::refused, "not enough memory for this input");
  } catch (const std::exception& fault) {
    return fail(ErrorKind::refused, fault.what());
  }
}

// Opens the page of --view in a browser for somebody who sits before a terminal and a display. What
// the browser says is nobody's business, and without one nothing happens.
void Program::show_page() const {
  const CLI::Option* const view = app_.get_option_no_throw("--view");
  const auto names_display = [](const char* variable) {
    const char* const display = std::getenv(variable);
    return display != nullptr && *display != '\0';
  };
  const bool has_display = names_display("DISPLAY") || names_display("WAYLAND_DISPLAY");
  if (view == nullptr || view->empty() || common_.quiet || !has_display ||
      ::isatty(STDERR_FILENO) == 0)
    return;
  const std::string page = view->results().back();
  if (file::descriptor_of(page) || ::access(page.c_str(), R_OK) != 0) return;
  std::signal(SIGHUP, SIG_IGN);  // of a terminal that closes now
  const pid_t browser = ::fork();
  if (browser != 0) return;
  const int nothing = ::open("/dev/null", O_RDWR);
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) ::dup2(nothing, stream);
  ::setsid();  // the browser does not close with the terminal
  ::execlp("xdg-open", "xdg-open", page.c_str(), nullptr);
  ::_exit(1);
}

// Returns the file of --config, as it was given.
std::string Program::config_name() const {
  const CLI::Option* option = app_.get_config_ptr();
  const std::string name = option->results().empty() ? "" : option->results().back();
  return name == "-" || name == "/dev/stdin" ? "standard input" : name;
}

// Refuses --grow=1e999, of which CLI11 makes whatever it can.
void Program::refuse_values_of_flags(int argc, char** argv) const {
  for (int k = 1; k < argc && std::string_view(argv[k]) != "--"; ++k) {
    const std::string argument = argv[k];
    const std::string name = argument.substr(0, argument.find('='));
    if (!name.starts_with("--") || name.size() == argument.size()) continue;
    const CLI::Option* option = app_.get_option_no_throw(name);
    if (option != nullptr && option->get_expected_max() == 0)
      refuse_usage(name + " takes no value; leave out " + argument.substr(name.size()));
  }
}

// Refuses empty values, which come of unset variables in scripts, and values other than true and
// false that a configuration gives to a flag.
void Program::refuse_senseless_values() const {
  for (const CLI::Option* option : app_.get_options()) {
    const std::vector<std::string>& values = option->results();
    if (option->get_expected_max() > 0 &&
        std::find(values.begin(), values.end(), "") != values.end())
      throw CLI::ValidationError(option->get_name(), kEmptyValue);
    for (const std::string& value : values) {  // as "-o $OUT --report" has it without OUT
      if (value.size() > 1 && value[0] == '-' && app_.get_option_no_throw(value) != nullptr)
        refuse_usage(option->get_name() + ": its value is missing; " + value + " is an option");
    }
    const bool is_nonsense = std::any_of(values.begin(), values.end(), [](const std::string& v) {
      return v != "true" && v != "false";
    });
    if (option->get_expected_max() == 0 && is_nonsense)
      throw CLI::ValidationError(option->get_name(), "give true or false");
  }
}

std::string Program::in_words_of_options(const std::string& text) const {
  return in_words_of_tools(text, [&](const std::string& name) {
    const CLI::Option* const option = app_.get_option_no_throw(name);
    if (option == nullptr || std::ranges::count(not_named_, name) > 0) return false;
    return !option->get_group().empty();  // those that are gone have none
  });
}

void Program::print(const char* kind, const std::string& text) const {
  std::cerr << name_ << ": " << kind << printable(in_words_of_options(text), kLongestMessage)
            << '\n';
}

void Program::note(const std::string& text) const {
  if (!common_.quiet) print("note: ", text);
}

void Program::warn(const std::string& text) const {
  print("warning: ", text);
}

void Program::error(const std::string& text) const {
  print("error: ", text);
}

void Program::detail(const std::string& text) const {
  if (common_.verbose && !common_.quiet) print("", text);
}

nlohmann::json Program::parameters() const {
  nlohmann::json all = nlohmann::json::parse(app_.config_to_str(true, false));
  for (const CLI::Option* option : app_.get_options()) {
    if (option->get_positional()) all.erase(config_key(*option));
  }
  for (const char* name :
       {"device",       "threads",   "quiet",  "verbose", "force",  // change no result
        "output",       "report",    "export", "stats",   "spheres-out", "out", "view",  // outputs
        "mesh",         "for-scene", "tool",   "cloud",   "poses",                       // inputs
        "list",         "shard",     "jobs",  // which inputs, and when
        "camera-poses", "frame-rate"}) {      // of recordings, whose frames know what comes of them
    all.erase(name);
  }
  return all;
}

std::string Program::configuration() const {
  return app_.config_to_str(false, false);
}

std::string differences(const nlohmann::json& a, const nlohmann::json& b) {
  std::string names;
  const auto add = [&](const std::string& name) { names += (names.empty() ? "" : ", ") + name; };
  for (const auto& [name, value] : a.items())
    if (!b.contains(name) || b[name] != value) add(name);
  for (const auto& [name, value] : b.items())
    if (!a.contains(name)) add(name);
  return names;
}

namespace {

// Throws if both outputs would be one file or stream.
void check_apart(const OutputFile& a, const OutputFile& b) {
  const std::optional<int> descriptor = file::descriptor_of(a.path);
  const bool share_descriptor = descriptor && descriptor == file::descriptor_of(b.path);
  if (share_descriptor && descriptor == STDOUT_FILENO)
    refuse_usage(std::string("only one output can be standard output: ") + b.option + " or " +
                 a.option);
  if (share_descriptor || file::is_same_file(a.path, b.path))
    refuse_usage(std::string(b.option) + " and " + a.option + " would both be written to " +
                 a.path + "; name two files");
}

}  // namespace

void check_files(const std::vector<std::string>& inputs, const std::vector<OutputFile>& outputs,
                 const CommonOptions& common) {
  for (auto a = outputs.begin(); a < outputs.end(); ++a)
    for (auto b = outputs.begin(); b < a; ++b) check_apart(*a, *b);
  for (const OutputFile& output : outputs) {
    if (common.force) {
      file::check_folder_of(output.path);
      continue;
    }
    for (const std::string& input : inputs) {
      if (file::is_same_file(output.path, input))
        refuse_usage(std::string(output.option) + " would overwrite the input " + input +
                     "; name another output, or give --force");
    }
    switch (output.form) {
      case OutputForm::by_name:
        file::check_output(output.path, output.kind);
        break;
      case OutputForm::json:
        file::check_json(output.path);
        break;
      case OutputForm::results:
        file::check_results(output.path);
        break;
      case OutputForm::page:
        file::check_page(output.path);
        break;
    }
  }
}

Progress::Progress(std::string what, const CommonOptions& common)
    : what_(std::move(what)), shown_(!common.quiet && isatty(STDERR_FILENO) != 0) {}

Progress::~Progress() {
  if (shown_ && percent_ >= 0) std::fputs("\r\033[K", stderr);
}

void Progress::update(double fraction) {
  if (!shown_ || !(fraction >= 0)) return;
  const int percent = static_cast<int>(std::floor(100 * std::min(fraction, 1.0)));
  if (percent == percent_) return;
  percent_ = percent;
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start_;
  std::fprintf(stderr, "\r%s %3d %%", what_.c_str(), percent);
  if (taken.count() > kSecondsToEstimate && fraction > 0) {
    std::fprintf(stderr, ", about %.0f s left\033[K", taken.count() * (1 / fraction - 1));
  }
}

}  // namespace vpm::tools
