// Declares what every function of the library throws: what is wrong, where, and how to mend it.
#pragma once

#include <vpm/export.h>

#include <memory>
#include <stdexcept>
#include <string>

namespace vpm {

enum class ErrorKind {
  refused,           // the data cannot be used: a damaged file, an open mesh, a pose that is none
  invalid_argument,  // the call means nothing: an option out of range, options that exclude others
  unavailable,       // a feature that is not built, a device that is not there or fails
  cannot_write,      // an output could not be written
};

// Its texts are plain English. Parameters and functions are named as the API names them, in
// backquotes: "give a wider `max_hole`", so that a program can put its own words there.
class VPM_API Error : public std::runtime_error {
 public:
  // Makes what() of the three texts: "where: what; hint". Parts that are empty are left out. Bytes
  // that could steer a terminal become \xNN, and a text of more than 1000 bytes is cut.
  Error(ErrorKind kind, const std::string& what, const std::string& where = {},
        const std::string& hint = {});
  Error(const Error&) = default;  // and none that moves: an error that is caught stays whole
  Error& operator=(const Error&) = default;

  // Returns whose fault it is, for programs that go on.
  ErrorKind kind() const noexcept { return kind_; }
  // Returns what is wrong, without place and hint.
  const std::string& problem() const noexcept { return parts_->problem; }
  // Returns the file, line or element, as far as it is known; may be empty.
  const std::string& where() const noexcept { return parts_->where; }
  // Returns how to mend it; may be empty.
  const std::string& hint() const noexcept { return parts_->hint; }

 private:
  struct Parts {
    std::string problem, where, hint;
  };
  Error(ErrorKind kind, std::shared_ptr<const Parts> parts);

  ErrorKind kind_;
  std::shared_ptr<const Parts> parts_;  // shared, so that copies of an exception cannot throw
};

}  // namespace vpm
