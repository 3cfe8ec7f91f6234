#include "libvpm/mesh/threemf_slicers.h"

#include <algorithm>
#include <array>
#include <optional>

#include "libvpm/core/error.h"
#include "libvpm/file/json_text.h"
#include "libvpm/file/text.h"
#include "libvpm/mesh/gltf_json.h"
#include "libvpm/mesh/xml_elements.h"

namespace vpm {
namespace {

std::uint64_t number_of(const XmlElement& element, std::string_view attribute) {
  return file::to_count(element.text_of(attribute)).value_or(0);
}

// Reads an element of either slicer's settings; their names differ.
void take(const XmlElement& element, std::uint64_t& object, SlicerSettings& settings) {
  const std::string& name = element.name();
  if (name == "object" && element.is_in({"config"})) {
    object = number_of(element, "id");
  } else if (name == "part" && element.is_in({"config", "object"})) {
    settings.parts[{object, number_of(element, "id")}] = element.text_of("subtype");
  } else if (name == "volume" && element.is_in({"config", "object"})) {
    settings.volumes[object].push_back(
        {number_of(element, "firstid"), number_of(element, "lastid"), ""});
  } else if (name == "metadata" && element.is_in({"config", "object", "volume"})) {
    std::string& role = settings.volumes[object].back().role;
    const std::string key = element.text_of("key"), value = element.text_of("value");
    if (key == "volume_type") role = value;
    if (key == "modifier" && value == "1" && role.empty())
      role = "modifier";  // as old files have it
  }
}

// Reads the project of PrusaSlicer 3, which is JSON.
void take(const nlohmann::json& project, SlicerSettings& settings) {
  for (const nlohmann::json& object : member(project, "objects")) {
    const std::uint64_t id = count_of(member(object, "id"));
    for (const nlohmann::json& volume : member(object, "volumes"))
      settings.parts[{id, count_of(member(volume, "id"))}] = text_of(member(volume, "type"));
    for (const nlohmann::json& instance : member(object, "instances")) {
      if (member(instance, "printable") == false && member(instance, "ord").is_number_unsigned())
        settings.unprinted.insert(count_of(member(instance, "ord")));
    }
  }
}

// Reads settings in XML, or in JSON. Returns what is wrong with them, if they are damaged.
std::optional<std::string> take(const std::string& text, bool is_json, SlicerSettings& settings) {
  if (is_json) {
    try {
      take(file::parse_json(text), settings);
    } catch (const Error& fault) {
      return std::string("it is ") + fault.problem();
    }
    return std::nullopt;
  }
  std::uint64_t object = 0;
  return read_xml(text, {[&](const XmlElement& element) { take(element, object, settings); }, {}});
}

}  // namespace

ThreemfRole role_of(const std::string& word) {
  const std::string lower = file::in_lower_case(word);
  const auto has = [&](const char* part) { return lower.find(part) != lower.npos; };
  if (has("negative")) return ThreemfRole::cut_away;
  constexpr std::array kLeftOut{"support",      "modifier", "overhang_mesh", "infill_mesh",
                                "cutting_mesh", "seam",     "brim"};
  const bool is_left_out =
      lower == "surface" || lower == "other" || std::any_of(kLeftOut.begin(), kLeftOut.end(), has);
  return is_left_out ? ThreemfRole::left_out : ThreemfRole::solid;
}

SlicerSettings slicer_settings(ZipArchive& archive, const std::string& name) {
  SlicerSettings settings;
  for (const std::string path :
       {"Metadata/Slic3r_PE_model.config", "Metadata/SuperSlicer_model.config",
        "Metadata/model_settings.config", "Metadata/PrusaSlicer3_project.json"}) {
    if (!archive.has(path)) continue;
    const auto text = archive.unpacked(path);
    const auto fault = text ? take(*text, path.ends_with(".json"), settings)
                            : std::optional<std::string>("it cannot be unpacked");
    if (!fault) continue;
    refuse("the slicer's settings '" + path + "', which tell what is solid, are damaged: " + *fault,
           name, "save it again, or export it as STL");
  }
  return settings;
}

}  // namespace vpm
