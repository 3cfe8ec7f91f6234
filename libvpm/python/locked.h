// Lets Python's threads ask one query in turn.
#pragma once

#include <pybind11/pybind11.h>

#include <memory>
#include <mutex>
#include <utility>

namespace vpm::python {

// A query, and the lock that lets one thread at a time ask it while others run Python.
template <class Asked>
struct Locked {
  template <class... Arguments>
  explicit Locked(Arguments&&... arguments) : query(std::forward<Arguments>(arguments)...) {}

  // Calls the function without Python's lock, one thread after another.
  template <class Action>
  auto ask(const Action& action) {
    const pybind11::gil_scoped_release unlocked;
    const std::lock_guard turn(*busy);
    return action(query);
  }

  Asked query;
  std::unique_ptr<std::mutex> busy = std::make_unique<std::mutex>();
};

}  // namespace vpm::python
