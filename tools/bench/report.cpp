#include "tools/bench/report.h"

#include <vpm/version.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <thread>

#include "libvpm/core/error.h"
#include "libvpm/file/stream.h"

namespace vpm::bench {
namespace {

// Returns text as RFC 4180 wants it: in quotes if it holds commas, quotes or line ends.
std::string quoted_if_needed(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + '"';
}

std::string text_of(const Table::Value& value) {
  if (const auto* text = std::get_if<std::string>(&value)) return quoted_if_needed(*text);
  char number[32];
  std::snprintf(number, sizeof number, "%.9g", std::get<double>(value));
  return number;
}

// Returns the first "model name" of /proc/cpuinfo, or an empty string.
std::string processor_name() {
  std::ifstream in("/proc/cpuinfo");
  for (std::string line; std::getline(in, line);) {
    const std::size_t colon = line.find(": ");
    if (line.rfind("model name", 0) == 0 && colon != std::string::npos)
      return line.substr(colon + 2);
  }
  return "";
}

}  // namespace

std::string to_csv(const Table& table) {
  std::string text;
  for (const std::string& column : table.columns) text += (text.empty() ? "" : ",") + column;
  text += '\n';
  for (const auto& row : table.rows) {
    std::string line;
    for (const Table::Value& value : row)
      line += (&value == row.data() ? "" : ",") + text_of(value);
    text += line + '\n';
  }
  return text;
}

nlohmann::json to_json(const Report& report, const std::string& command) {
  return {{"suite", report.suite},
          {"version", VPM_VERSION},
          {"commit", VPM_COMMIT},
          {"command", command},
          {"machine",
           {{"processor", processor_name()},
            {"cores", std::thread::hardware_concurrency()},
            {"compiler", VPM_COMPILER},
            {"build_type", VPM_BUILD_TYPE}}},
          {"settings", report.settings},
          {"results", report.results}};
}

void make_folder(const std::string& folder) {
  if (std::filesystem::is_directory(folder)) return;
  std::error_code fault;
  std::filesystem::create_directory(folder, fault);
  if (!fault) return;
  const std::string advice = fault == std::errc::no_such_file_or_directory
                                 ? "; correct its name, or make the folder above it"
                                 : "";
  throw Error(ErrorKind::cannot_write,
              "cannot make the folder " + folder + ": " + fault.message() + advice);
}

void write(const Report& report, const std::string& command, const std::string& folder) {
  make_folder(folder);
  const std::string stem = folder + "/" + report.suite;
  file::write_all(stem + ".json", std::string_view(to_json(report, command).dump(2) + "\n"));
  file::write_all(stem + ".csv", std::string_view(to_csv(report.table)));
}

}  // namespace vpm::bench
