// Catches refusals of calls.
#pragma once

#include <optional>
#include <string>

#include "libvpm/core/error.h"

namespace vpm::test {

// Returns the Error that the action throws; nothing if it throws none.
template <class Action>
std::optional<Error> fault_of(const Action& action) {
  try {
    action();
  } catch (const Error& fault) {
    return fault;
  }
  return std::nullopt;
}

template <class Action>
std::optional<ErrorKind> kind_of_fault(const Action& action) {
  const std::optional<Error> fault = fault_of(action);
  return fault ? std::optional(fault->kind()) : std::nullopt;
}

// Returns the message of the fault, or "" if there is none.
template <class Action>
std::string refusal(const Action& action) {
  const std::optional<Error> fault = fault_of(action);
  return fault ? fault->what() : "";
}

}  // namespace vpm::test
