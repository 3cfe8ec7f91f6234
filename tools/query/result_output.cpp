#include "tools/query/result_output.h"

#include <vpm/version.h>

#include <filesystem>
#include <system_error>
#include <utility>

#include "libvpm/file/checksum.h"
#include "libvpm/file/text.h"
#include "libvpm/recording/mcap/ros_recording.h"
#include "tools/common/error_text.h"
#include "tools/query/solid_scene.h"

namespace vpm::tools {
namespace {

constexpr CsvColumn kResult[] = {
    {"pose", "/pose"},
    {"id", "/id"},
    {"tool", "/tool"},
    {"time", "/time"},
    {"frame", "/frame"},
    {"volume", "/volume"},
    {"volume_fraction", "/volume_fraction"},
    {"seen_free", "/seen_free"},
    {"unseen", "/unseen"},
    {"out_of_view", "/out_of_view"},
    {"force_x", "/force/0"},
    {"force_y", "/force/1"},
    {"force_z", "/force/2"},
    {"torque_x", "/torque/0"},
    {"torque_y", "/torque/1"},
    {"torque_z", "/torque/2"},
    {"boundary", "/boundary"},
    {"inside", "/inside"},
    {"points", "/points"},
    {"closure", "/closure"},
    {"level", "/level"},
    {"measure", "/measure"},
    {"level_reason", "/level_reason"},
    {"bodies", "/bodies"},
    {"collides", "/collides"},
    {"above", "/above"},
    {"contacts", "/contacts"},
    {"volume_low", "/volume_interval/0"},
    {"volume_high", "/volume_interval/1"},
};

constexpr CsvColumn kCoupling[] = {
    {"step", "/step"},
    {"time", "/time"},
    {"frame", "/frame"},
    {"device_tx", "/device/0"},
    {"device_ty", "/device/1"},
    {"device_tz", "/device/2"},
    {"device_qx", "/device/3"},
    {"device_qy", "/device/4"},
    {"device_qz", "/device/5"},
    {"device_qw", "/device/6"},
    {"tool_tx", "/tool/0"},
    {"tool_ty", "/tool/1"},
    {"tool_tz", "/tool/2"},
    {"tool_qx", "/tool/3"},
    {"tool_qy", "/tool/4"},
    {"tool_qz", "/tool/5"},
    {"tool_qw", "/tool/6"},
    {"volume", "/volume"},
    {"volume_fraction", "/volume_fraction"},
    {"force_x", "/force/0"},
    {"force_y", "/force/1"},
    {"force_z", "/force/2"},
    {"torque_x", "/torque/0"},
    {"torque_y", "/torque/1"},
    {"torque_z", "/torque/2"},
    {"rendered_force_x", "/rendered_force/0"},
    {"rendered_force_y", "/rendered_force/1"},
    {"rendered_force_z", "/rendered_force/2"},
    {"rendered_torque_x", "/rendered_torque/0"},
    {"rendered_torque_y", "/rendered_torque/1"},
    {"rendered_torque_z", "/rendered_torque/2"},
    {"supplied", "/energy/supplied"},
    {"stored", "/energy/stored"},
    {"dissipated", "/energy/dissipated"},
    {"absorbed", "/energy/absorbed"},
    {"lost", "/energy/lost"},
};

// Returns the hash of a file, or null if it has no name, is a folder, or cannot be read twice. Of
// poses in a recording the name is compared, as that of frames is.
nlohmann::json hash_of(const std::string& name) {
  std::error_code fault;
  if (mcap::poses_name(name)) return name;
  if (name.empty() || !std::filesystem::is_regular_file(name, fault)) return nullptr;
  return file::content_hash({file::read_all(name)});
}

// Returns all that lines of results depend on. Throws Error(invalid_argument) with --resume if an
// input cannot be compared with that of the run before.
nlohmann::json run_of(const Program& program, const Arguments& a,
                      const std::vector<std::string>& more_inputs) {
  nlohmann::json run = program.parameters();
  for (const char* name : {"resume", "batch", "realtime", "remove", "urdf", "joints", "srdf"})
    run.erase(name);
  run["version"] = VPM_VERSION;
  run["frames"] = a.replay.frames;
  run["frame-rate"] = a.replay.frame_rate;
  const auto add = [&](const char* option, const std::string& name) {
    const nlohmann::json hash = hash_of(name);
    if (a.resume && !name.empty() && hash.is_null())
      refuse_usage("--resume compares files with those of the run before: name one for --" +
                   std::string(option) + " in place of " + name);
    run[option].push_back(hash);
  };
  for (const std::string& tool : a.tools) add("tool", tool);
  for (const std::string& solid : a.solids) add("solids", solid_from_text(solid, "--solid").name);
  for (const std::string& cloud : a.clouds) add("cloud", cloud);
  if (a.clouds.empty()) add("cloud", {});
  for (const std::string& poses : a.poses) add("poses", poses);
  for (const std::string& poses : a.replay.camera_poses) add("camera-poses", poses);
  add("remove", a.replay.remove);
  for (const auto& [option, name] :
       {std::pair{"urdf", a.urdf}, {"joints", a.joints}, {"srdf", a.srdf}})
    add(option, name);
  for (const std::string& name : more_inputs) add("meshes", name);
  return run;
}

std::string json_text(const nlohmann::ordered_json& value) {
  return value.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

// Returns the field of a value, in quotes where it needs them (RFC 4180).
std::string csv_field(const nlohmann::ordered_json& value) {
  const std::string text = value.is_string() ? value.get<std::string>() : json_text(value);
  if (text.find_first_of(",\"\r\n") == text.npos) return text;
  std::string quoted = "\"";
  for (const char letter : text)
    quoted += letter == '"' ? std::string("\"\"") : std::string(1, letter);
  return quoted + "\"";
}

std::string names_of(std::span<const CsvColumn> columns) {
  std::string names;
  for (const CsvColumn& column : columns)
    names += (names.empty() ? "" : ",") + std::string(column.name);
  return names;
}

// Returns the line as CSV, or as JSON where there are no columns.
std::string text_of_line(const nlohmann::ordered_json& line, std::span<const CsvColumn> columns) {
  if (columns.empty()) return json_text(line);
  std::string text;
  for (const CsvColumn& column : columns) {
    const nlohmann::ordered_json::json_pointer place(column.pointer);
    if (&column != columns.data()) text += ',';
    if (line.contains(place)) text += csv_field(line[place]);
  }
  return text;
}

}  // namespace

std::span<const CsvColumn> result_columns() {
  return kResult;
}

std::span<const CsvColumn> coupling_columns() {
  return kCoupling;
}

void write_lines(const std::string& path, std::span<const CsvColumn> columns,
                 std::span<const nlohmann::ordered_json> lines) {
  if (!is_csv(path)) columns = {};
  std::string text = columns.empty() ? "" : names_of(columns) + "\n";
  for (const nlohmann::ordered_json& line : lines) text += text_of_line(line, columns) + "\n";
  file::write_all(path, text);
}

ResultOutput::ResultOutput(const Program& program, const Arguments& arguments,
                           std::span<const CsvColumn> columns,
                           const std::vector<std::string>& more_inputs)
    : program_(program), path_(arguments.output) {
  if (KeptLines::are_kept(path_))
    kept_.emplace(path_, run_of(program, arguments, more_inputs),
                  leftover_of(arguments, program.common()));
  else
    straight_.emplace(path_);
  there_ = kept_ ? kept_->lines() : 0;
  if (!is_csv(path_)) return;
  columns_ = columns;
  if (there_ > 0) {  // the first line has the names
    --there_;
    return;
  }
  names_ = names_of(columns);
}

ResultOutput::~ResultOutput() {
  const std::size_t lines = kept_ ? kept_->lines() : 0;
  if (lines > 0 && !is_finished_)
    program_.note(std::to_string(lines) + " lines are kept in " + path_ +
                  ".part: --resume goes on after them");
}

std::size_t ResultOutput::pass_over(std::size_t lines) {
  const std::size_t poses = there_ / lines;
  there_ %= lines;
  return poses;
}

std::string ResultOutput::text_of(const nlohmann::ordered_json& line) const {
  return text_of_line(line, columns_) + "\n";
}

void ResultOutput::append(const std::string& text, std::size_t lines) {
  if (there_ > 0) {
    --there_;
    return;
  }
  write_names();
  write(text, lines);
}

void ResultOutput::finish() {
  write_names();
  kept_ ? kept_->finish() : straight_->finish();
  is_finished_ = true;
}

void ResultOutput::write_names() {
  if (!names_.empty()) write(std::exchange(names_, {}) + "\n", 1);
}

void ResultOutput::write(const std::string& text, std::size_t lines) {
  kept_ ? kept_->append(text, lines) : straight_->append(text);
}

}  // namespace vpm::tools
