// Lines of results in a file: JSON Lines, or CSV if its name ends in .csv.
#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>

#include "libvpm/file/stream.h"

namespace vpm::tools {

// Column of CSV: its name, and the place of its value in a line of JSON, as a JSON pointer. The
// column is empty where a line has no such value.
struct CsvColumn {
  const char* name;
  const char* pointer;
};

// Columns of formats/schemas/query-result.json and coupling-step.json.
std::span<const CsvColumn> result_columns();
std::span<const CsvColumn> coupling_columns();

class ResultOutput {
 public:
  // Opens the output, and writes the names of the columns to CSV. Throws as file::Output.
  ResultOutput(const std::string& path, std::span<const CsvColumn> columns);

  // Writes a line at once. File names that are not UTF-8 are escaped in JSON.
  void append(const nlohmann::ordered_json& line);
  void finish() { output_.finish(); }

 private:
  file::Output output_;
  std::span<const CsvColumn> columns_;  // none for JSON
};

}  // namespace vpm::tools
