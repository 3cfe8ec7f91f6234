#include "tools/query/result_output.h"

#include <filesystem>

#include "libvpm/file/text.h"

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

}  // namespace

std::span<const CsvColumn> result_columns() {
  return kResult;
}

std::span<const CsvColumn> coupling_columns() {
  return kCoupling;
}

ResultOutput::ResultOutput(const std::string& path, std::span<const CsvColumn> columns)
    : output_(path) {
  if (file::in_lower_case(std::filesystem::path(path).extension().string()) != ".csv") return;
  columns_ = columns;
  std::string names;
  for (const CsvColumn& column : columns)
    names += (names.empty() ? "" : ",") + std::string(column.name);
  output_.append(names + "\n");
}

void ResultOutput::append(const nlohmann::ordered_json& line) {
  if (columns_.empty()) return output_.append(json_text(line) + "\n");
  std::string text;
  for (const CsvColumn& column : columns_) {
    const nlohmann::ordered_json::json_pointer place(column.pointer);
    if (&column != columns_.data()) text += ',';
    if (line.contains(place)) text += csv_field(line[place]);
  }
  output_.append(text + "\n");
}

}  // namespace vpm::tools
