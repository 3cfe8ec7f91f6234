// Runs a program once for each input of a list, in processes that take one after the other
// (list_worker.h): whatever happens to an input, the others have their results.
#pragma once

#include "tools/common/list_entries.h"

namespace vpm::tools {

// Adds the options to `app`, which writes their values to `arguments`.
void declare_list(CLI::App& app, ListArguments& arguments);

// False if no list is given. Otherwise runs the program for each entry of the list whose outputs
// are not there and valid, prints a table of what was done, and lets the program end with the
// smallest answer of a run to a script's question that is not 0. Throws Error(refused) at the end
// if runs failed, after a line for each of them, and what read_list() and ListRecord() throw before
// the first.
bool run_list(Program& program, const ListArguments& arguments, const ListedInput& input);

}  // namespace vpm::tools
