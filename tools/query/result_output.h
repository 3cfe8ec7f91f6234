// Lines of results in a file: JSON Lines, or CSV if its name ends in .csv.
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "libvpm/file/stream.h"
#include "tools/query/arguments.h"

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

// Writes the lines at once to a file, or to standard output ("-"): as CSV if its name ends in .csv.
// Throws Error(cannot_write).
void write_lines(const std::string& path, std::span<const CsvColumn> columns,
                 std::span<const nlohmann::ordered_json> lines);

class ResultOutput {
 public:
  // Opens the output of --output, whose first line in CSV has the columns' names. Lines of a file
  // are kept if the run is interrupted (kept_lines.h), and go on after those that are there with
  // --resume, if `more_inputs`, files that no option names, are the same, too. The program and its
  // arguments must outlive this. Throws as file::Output and KeptLines.
  ResultOutput(const Program& program, const Arguments& arguments,
               std::span<const CsvColumn> columns,
               const std::vector<std::string>& more_inputs = {});
  // Says how to go on if lines are kept.
  ~ResultOutput();
  ResultOutput(const ResultOutput&) = delete;
  ResultOutput& operator=(const ResultOutput&) = delete;

  // Returns the number of poses whose lines are all there, at `lines` for each: append() expects
  // the next pose. To be called first, and only if a pose does not depend on those before it;
  // otherwise append() passes over the lines that are there.
  std::size_t pass_over(std::size_t lines);
  // Writes a line at once. File names that are not UTF-8 are escaped in JSON.
  void append(const nlohmann::ordered_json& line) { append(text_of(line), 1); }

  // The two parts of append(): the first may be called by many threads at once, and returns the
  // line as it is written, with its end; the second writes the text of whole lines, several only
  // where none is passed over.
  std::string text_of(const nlohmann::ordered_json& line) const;
  void append(const std::string& text, std::size_t lines);
  void finish();

 private:
  void write_names();
  void write(const std::string& text, std::size_t lines);

  const Program& program_;
  const std::string& path_;
  std::span<const CsvColumn> columns_;  // none for JSON
  std::string names_;                   // of the columns, until they are written
  std::optional<KeptLines> kept_;       // either this one
  std::optional<file::Output> straight_;
  std::size_t there_ = 0;  // lines of results of an earlier run that append() has yet to reach
  bool is_finished_ = false;
};

}  // namespace vpm::tools
