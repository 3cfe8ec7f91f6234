// What a call refuses.
#pragma once

#include <optional>
#include <string>

#include "libvpm/core/error.h"

namespace vpm::test {

// The Error that the action throws; none where it throws none.
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

// The words of the fault; "" where there is none.
template <class Action>
std::string refusal(const Action& action) {
  const std::optional<Error> fault = fault_of(action);
  return fault ? fault->what() : "";
}

}  // namespace vpm::test
