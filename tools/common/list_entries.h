// Inputs of a list, each with the options of its run and the names of its outputs.
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tools/common/program.h"

namespace vpm::tools {

// Values of the options of lists.
struct ListArguments {
  std::string list, shard;
  int jobs = 0;  // runs at a time; 0: one per core, or per GPU that runs use
};

// Which option of a program takes the input that a line names, and how the names of its outputs
// end.
struct ListedInput {
  const char* option;  // without dashes, as in a configuration
  const char* ending;  // with its dot
};

// One run of the program.
struct ListEntry {
  std::string input;       // for messages
  nlohmann::json options;  // for --config, all but how many threads it has
  nlohmann::json result;   // options that the result depends on

  // Returns the names of the files that the run writes; --output's is the first.
  std::vector<std::string> outputs() const;
  // Returns the names of all files that the run's options name, outputs apart.
  std::vector<std::string> inputs() const;
};

// Reads the list, and returns the entries of the shard in the list's order. A line is the name of
// an input, or a JSON object of options that this input has of its own; empty lines and those that
// begin with # are passed over. In names of outputs {} becomes the input's path from the working
// folder without its ending, in other options its path as it is written without its ending;
// an --output without {} is a folder. Throws Error(refused) for the list, and
// Error(invalid_argument) for options that do not go with it, or where two entries have one output.
std::vector<ListEntry> read_list(const Program& program, const ListArguments& arguments,
                                 const ListedInput& input);

}  // namespace vpm::tools
