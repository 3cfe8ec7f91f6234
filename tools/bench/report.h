// Result of a suite: a table for plots and JSON for the record.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <variant>
#include <vector>

namespace vpm::bench {

struct Table {
  using Value = std::variant<std::string, double>;
  std::vector<std::string> columns;
  std::vector<std::vector<Value>> rows;
};

struct Report {
  std::string suite;
  nlohmann::json settings = nlohmann::json::object();  // sizes, seeds and counts of the run
  nlohmann::json results = nlohmann::json::array();
  Table table;
  std::string summary;  // printed to the terminal
  std::string failure;  // the promise that was broken, if any; the program then exits with 1
};

// Returns comma-separated text with a header line; numbers have 9 digits, text no commas.
std::string to_csv(const Table& table);

// Returns suite, version, commit, machine, compiler, command, settings and results. Holds no clock
// time.
nlohmann::json to_json(const Report& report, const std::string& command);

// Makes the folder before the work begins, so that a refusal comes at once; but no folders above
// it, whose names may be typing errors. Throws Error(cannot_write).
void make_folder(const std::string& folder);

// Writes <folder>/<suite>.json and .csv; makes the folder. Throws Error(cannot_write).
void write(const Report& report, const std::string& command, const std::string& folder);

}  // namespace vpm::bench
