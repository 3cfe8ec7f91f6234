// What went wrong, in words for the person at the terminal: what, where, and how to mend it.
#pragma once

#include <stdexcept>
#include <string>

namespace vpm {

// The value is the exit code of the executables.
enum class ErrorKind {
  refused = 1,       // the input or the data was refused
  usage = 2,         // the command line or configuration is wrong
  unavailable = 3,   // a feature that is not built, or a device that is not there
  cannot_write = 4,  // an output could not be written
};

class Error : public std::runtime_error {
 public:
  Error(ErrorKind kind, const std::string& message) : std::runtime_error(message), kind_(kind) {}
  ErrorKind kind() const { return kind_; }

 private:
  ErrorKind kind_;
};

[[noreturn]] inline void refuse(const std::string& message) {
  throw Error(ErrorKind::refused, message);
}

}  // namespace vpm
