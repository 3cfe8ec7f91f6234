// What a suite measured: a table for plots and JSON for the record.
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
  nlohmann::json settings = nlohmann::json::object();  // what was run: sizes, seeds, counts
  nlohmann::json results = nlohmann::json::array();
  Table table;
  std::string summary;  // for the terminal
  std::string failure;  // what broke a promise; empty: nothing. The program then ends with 1.
};

// Comma-separated with a header line; numbers with 9 digits, text without commas.
std::string to_csv(const Table& table);

// Suite, version, commit, machine, compiler, command, settings, results. No clock time.
nlohmann::json to_json(const Report& report, const std::string& command);

// Before the work, so that nobody waits for a refusal. Throws Error(cannot_write).
void make_folder(const std::string& folder);

// Writes <folder>/<suite>.json and .csv; makes the folder. Throws Error(cannot_write).
void write(const Report& report, const std::string& command, const std::string& folder);

}  // namespace vpm::bench
