// Lets Python's threads ask one query in turn.
#pragma once

#include <pybind11/pybind11.h>
#include <vpm/query_types.h>
#include <vpm/tool.h>

#include <mutex>
#include <utility>
#include <vector>

namespace vpm::python {

// Holds a query that threads of Python ask in turn: a C++ query belongs to one thread at a time,
// and Python's own lock is given up while it computes.
template <class Asked>
struct Locked {
  template <class... Arguments>
  explicit Locked(Arguments&&... arguments) : query(std::forward<Arguments>(arguments)...) {}

  // Calls the function without Python's lock, one thread after another.
  template <class Action>
  auto ask(const Action& action) {
    const pybind11::gil_scoped_release unlocked;
    const std::lock_guard turn(busy);
    return action(query);
  }

  Asked query;
  std::mutex busy;
};

// The same, with what the query was made of, which pages show.
template <class Asked>
struct ToolQuery : Locked<Asked> {
  template <class... Arguments>
  ToolQuery(std::vector<Tool> of, const QueryOptions& with, Arguments&&... arguments)
      : Locked<Asked>(std::forward<Arguments>(arguments)...), tools(std::move(of)), options(with) {}

  std::vector<Tool> tools;
  QueryOptions options;
};

}  // namespace vpm::python
