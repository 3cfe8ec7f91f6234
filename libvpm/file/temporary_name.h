// Names of the files that outputs are written to before they are whole.
#pragma once

#include <string>

namespace vpm::file {

// Returns ".NAME.vpm-PID-NUMBER.tmp", which says which output of which process it is. NAME is the
// target's, cut if it is long.
std::string temporary_name(const std::string& target, int number);

// Removes the temporary files in a folder whose processes were killed: no process has the number,
// and none holds the file's lock. Ignores what it cannot read or remove.
void remove_leftovers(const std::string& folder);

}  // namespace vpm::file
