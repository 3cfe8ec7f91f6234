#include "tools/common/early_failure.h"

#include <unistd.h>
#include <vpm/error.h>

#include <cstring>
#include <exception>
#include <filesystem>
#include <string>
#include <system_error>

#include "tools/common/error_text.h"

namespace vpm::tools {
namespace {

std::terminate_handler usual_handler = nullptr;
const char* program_name = "vpm";

std::string reason() {
  try {
    std::rethrow_exception(std::current_exception());
  } catch (const std::filesystem::filesystem_error& fault) {
    return fault.what();
  } catch (const std::system_error& fault) {
    return "a thread is refused (" + fault.code().message() +
           "); allow more processes (ulimit -u) or more memory (ulimit -v)";
  } catch (const std::bad_alloc&) {
    return "there is no memory; allow more (ulimit -v)";
  } catch (const std::exception& fault) {
    return fault.what();
  } catch (...) {
    return "a library fails";
  }
}

[[noreturn]] void say_and_exit() {
  const std::string message = program_name + std::string(": error: cannot start: ") +
                              (std::current_exception() ? reason() : "a library fails") + '\n';
  // Gives the exit code also where standard error is closed.
  if (::write(STDERR_FILENO, message.data(), message.size()) < 0)
    ::_exit(exit_code(ErrorKind::unavailable));
  ::_exit(exit_code(ErrorKind::unavailable));
}

void watch_the_start(int, char** argv, char**) {
  if (argv != nullptr && argv[0] != nullptr) {
    const char* const slash = std::strrchr(argv[0], '/');
    program_name = slash != nullptr ? slash + 1 : argv[0];
  }
  usual_handler = std::set_terminate(say_and_exit);
}

// Runs before the constructors of shared libraries; only executables may have such functions.
[[gnu::section(".preinit_array"), gnu::used]] void (*const watch)(int, char**,
                                                                  char**) = watch_the_start;

}  // namespace

void end_of_early_failures() {
  if (std::get_terminate() == say_and_exit) std::set_terminate(usual_handler);
}

}  // namespace vpm::tools
