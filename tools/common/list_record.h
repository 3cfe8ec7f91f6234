// What is known of the outputs of an entry of a list: a file .NAME.done beside each output NAME.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "tools/common/list_entries.h"

namespace vpm::tools {

// State of an entry's outputs: not there, begun by a run that did not end, made of other inputs or
// damaged, or as they were made.
enum class Outputs { none, begun, stale, valid };

// Hashes of files, each of which is read once; null for what is no file.
class Hashes {
 public:
  const nlohmann::json& of(const std::string& path);

 private:
  std::map<std::string, nlohmann::json> known_;
};

// Not thread-safe.
class ListRecord {
 public:
  // Reads the record, if there is one. Throws Error(invalid_argument) if it is of a run with other
  // options or another version.
  ListRecord(const Program& program, const ListEntry& entry);

  // Outputs are valid if they are those of the last run, byte for byte, and its inputs are the
  // same. Throws Error(invalid_argument) if a file is there that no run of a list wrote.
  Outputs state(Hashes& hashes) const;
  // Makes the folders of the outputs and says that their run begins. Throws Error(cannot_write).
  void begin(Hashes& hashes);
  // Forgets that a run began, which wrote nothing.
  void forget() const;
  // Says that the outputs are whole: how the program exited, and what it said.
  void finish(int exit_code, const std::vector<std::string>& said);

  // Of the last whole run.
  int exit_code() const { return record_.value("exit_code", 0); }
  std::vector<std::string> said() const;

 private:
  void write() const;

  const ListEntry& entry_;
  std::string path_;
  nlohmann::json run_;     // what is known before the run
  nlohmann::json record_;  // what the file holds; null if there is none
};

}  // namespace vpm::tools
