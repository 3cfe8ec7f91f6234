#include "tools/common/list_record.h"

#include <vpm/error.h>
#include <vpm/version.h>

#include <filesystem>
#include <system_error>

#include "libvpm/file/checksum.h"
#include "libvpm/file/stream.h"
#include "tools/common/error_text.h"

namespace vpm::tools {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

// Returns what tells a folder's content without reading it: names, sizes and times of its files.
Json hash_of_folder(const std::string& path) {
  Json files = Json::object();
  for (const auto& file : fs::recursive_directory_iterator(path))
    if (file.is_regular_file())
      files[file.path().string()] = {file.file_size(),
                                     file.last_write_time().time_since_epoch().count()};
  const std::string text = files.dump(-1, ' ', false, Json::error_handler_t::replace);
  return file::content_hash({std::as_bytes(std::span(text))});
}

Json hash_of(const std::string& path) {
  std::error_code fault;
  if (fs::is_directory(path, fault)) return hash_of_folder(path);
  if (!fs::is_regular_file(path, fault)) return nullptr;
  return file::content_hash({file::read_all(path)});
}

// Returns the hashes of those of the entry's texts that name files, solids before their poses.
Json inputs_of(const ListEntry& entry, Hashes& hashes) {
  Json inputs = Json::object();
  for (const std::string& text : entry.inputs())
    for (const std::string& name : {text, text.substr(0, text.rfind('@'))})
      if (const Json& hash = hashes.of(name); !hash.is_null()) inputs[name] = hash;
  return inputs;
}

// Outputs change, so that they are read each time. Their names are those from the record's folder,
// which may be moved.
Json outputs_of(const ListEntry& entry) {
  const std::vector<std::string> names = entry.outputs();
  const fs::path folder = fs::path(names.front()).parent_path();
  Json outputs = Json::object();
  for (const std::string& name : names)
    outputs[fs::path(name).lexically_proximate(folder).string()] = hash_of(name);
  return outputs;
}

std::string record_of(const std::string& output) {
  const fs::path path(output);
  return (path.parent_path() / ("." + path.filename().string() + ".done")).string();
}

}  // namespace

const Json& Hashes::of(const std::string& path) {
  const auto [place, is_new] = known_.try_emplace(path);
  if (is_new) place->second = hash_of(path);
  return place->second;
}

ListRecord::ListRecord(const Program& program, const ListEntry& entry)
    : entry_(entry),
      path_(record_of(entry.outputs().front())),
      run_({{"program", program.name()}, {"version", VPM_VERSION}, {"options", entry.result}}) {
  std::error_code fault;
  if (!fs::exists(path_, fault)) return;
  record_ = Json::parse(file::read_all(path_), nullptr, false);
  if (!record_.is_object() || !record_["options"].is_object()) record_ = nullptr;
  if (record_.is_null() || program.common().force) return;
  std::string names = differences(record_["options"], entry.result);
  for (const char* const name : {"program", "version"})
    if (record_[name] != run_[name]) names += (names.empty() ? "" : ", ") + std::string(name);
  if (!names.empty())
    throw Error(ErrorKind::invalid_argument,
                entry.outputs().front() + " is of a run with other " + names, {},
                "name another folder for --output, or give --force to make all of the list anew");
}

Outputs ListRecord::state(Hashes& hashes) const {
  if (record_.is_null()) {
    std::error_code fault;
    for (const std::string& output : entry_.outputs())
      if (fs::exists(output, fault))
        throw Error(ErrorKind::invalid_argument, output + " is there, and was not made by --list",
                    {}, "name another folder for --output, or give --force to overwrite it");
    return Outputs::none;
  }
  if (!record_.contains("outputs")) return Outputs::begun;
  const bool is_valid =
      record_["inputs"] == inputs_of(entry_, hashes) && record_["outputs"] == outputs_of(entry_);
  return is_valid ? Outputs::valid : Outputs::stale;
}

void ListRecord::begin(Hashes& hashes) {
  for (const std::string& output : entry_.outputs()) {
    const fs::path folder = fs::path(output).parent_path();
    std::error_code fault;
    if (!folder.empty()) fs::create_directories(folder, fault);
    if (fault)
      throw Error(ErrorKind::cannot_write,
                  "cannot make the folder " + folder.string() + ": " + fault.message());
  }
  record_ = run_;
  record_["inputs"] = inputs_of(entry_, hashes);
  write();
}

void ListRecord::forget() const {
  std::error_code fault;
  fs::remove(path_, fault);
}

void ListRecord::finish(int exit_code, const std::vector<std::string>& said) {
  record_["outputs"] = outputs_of(entry_);
  record_["exit_code"] = exit_code;
  record_["said"] = said;
  write();
}

std::vector<std::string> ListRecord::said() const {
  return record_.value("said", std::vector<std::string>{});
}

void ListRecord::write() const {
  file::write_all(path_, record_.dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
}

}  // namespace vpm::tools
