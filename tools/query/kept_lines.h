// Lines of results that outlive an interrupted run: they stand beside the output's name until the
// run ends.
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace vpm::tools {

// What becomes of the lines that an earlier run left.
enum class Leftover { refuse, resume, discard };

// True for the name of a file that holds CSV.
bool is_csv(const std::string& path);

// A file NAME whose lines are written at once to NAME.part, which becomes NAME at the end. What the
// lines depend on stands in NAME.part.json, so that another run can go on after the last whole one.
// Not thread-safe.
class KeptLines {
 public:
  // True if a file will have this name, which is no pipe, device or standard output.
  static bool are_kept(const std::string& path);
  // Returns the files that hold the lines and what they depend on until they are done.
  static std::vector<std::string> beside(const std::string& path);
  // Throws Error(invalid_argument) if there are lines of an earlier run that are refused.
  static void check(const std::string& path, Leftover leftover);
  // True if the run that should go on has ended: the file has its name, and no lines are left.
  static bool are_finished(const std::string& path, Leftover leftover);

  // Opens NAME.part. `run` maps names to all that lines depend on. With Leftover::resume keeps the
  // whole lines that are there. Throws Error(invalid_argument) if they are of another run, and
  // Error(cannot_write).
  KeptLines(const std::string& path, const nlohmann::json& run, Leftover leftover);
  // Keeps what was written, unless that is nothing.
  ~KeptLines();
  KeptLines(const KeptLines&) = delete;
  KeptLines& operator=(const KeptLines&) = delete;

  // Returns the number of lines that are there.
  std::size_t lines() const { return lines_; }
  // Writes whole lines, with their ends.
  void append(std::string_view text, std::size_t lines);
  // Gives the file its name.
  void finish();

 private:
  void open();
  void go_on(const nlohmann::json& run);

  std::string target_, part_, told_;
  int descriptor_ = -1;
  std::size_t lines_ = 0;
  bool is_finished_ = false;
};

}  // namespace vpm::tools
