#include "tools/query/pairs_assembly.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string_view>
#include <system_error>
#include <utility>

#include "libvpm/core/error.h"
#include "libvpm/file/json_text.h"
#include "libvpm/file/nearest_word.h"
#include "libvpm/file/stream.h"
#include "libvpm/file/text.h"
#include "libvpm/recording/pose_json.h"
#include "libvpm/recording/pose_numbers.h"
#include "libvpm/recording/pose_reader.h"
#include "tools/common/error_text.h"
#include "tools/common/length_units.h"
#include "tools/common/mesh_tool.h"

namespace vpm::tools {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

// True if the name is the pattern, in which * stands for any letters.
bool is_like(std::string_view name, std::string_view pattern) {
  const std::size_t star = pattern.find('*');
  if (star == pattern.npos) return name == pattern;
  if (!name.starts_with(pattern.substr(0, star))) return false;
  name.remove_prefix(star);
  pattern.remove_prefix(star + 1);
  // The shortest stretch for each * is enough: what follows it has the most room then.
  for (std::size_t next = pattern.find('*'); next != pattern.npos; next = pattern.find('*')) {
    const std::size_t at = name.find(pattern.substr(0, next));
    if (at == name.npos) return false;
    name.remove_prefix(at + next);
    pattern.remove_prefix(next + 1);
  }
  return name.ends_with(pattern);
}

// Throws Error(refused) if the object has a key that is none of the known ones.
void check_keys(const json& object, const std::vector<std::string>& known,
                const std::string& where) {
  if (!object.is_object()) refuse("it is no object", where, "write {\"" + known.front() + "\": …}");
  for (const auto& [key, value] : object.items()) {
    if (std::ranges::count(known, key) > 0) continue;
    const std::string guess = file::guess_of_word(key, known);
    refuse("there is no key '" + file::shown(key) + "'", where,
           guess.empty() ? "known are " + file::listed(known) : guess);
  }
}

std::string text_at(const json& object, const char* key, const std::string& where) {
  const json& value = object[key];
  if (!value.is_string() || value.get_ref<const std::string&>().empty() ||
      value.get_ref<const std::string&>().find('\0') != std::string::npos)
    refuse(std::string("\"") + key + "\" is no text", where, "write it in quotation marks");
  return value.get<std::string>();
}

Pose pose_at(const json& object, const std::string& where, double& largest_deviation) {
  try {
    double deviation = 0;
    const Pose pose = from_untimed(pose_of_object({{"pose", object["pose"]}}).numbers, &deviation);
    largest_deviation = std::max(largest_deviation, deviation);
    return pose;
  } catch (const Error& error) {
    throw Error(error.kind(), "\"pose\": " + error.problem(), where, error.hint());
  }
}

AssemblyPart part_of(const json& object, const fs::path& folder, const std::string& where,
                     double& largest_deviation) {
  check_keys(object, {"mesh", "name", "node", "pose"}, where);
  if (!object.contains("mesh")) refuse("\"mesh\" is missing", where, "name the part's file");
  const std::string mesh = text_at(object, "mesh", where);
  AssemblyPart part{mesh, (folder / mesh).string(), {}, {}};
  if (object.contains("name")) part.name = text_at(object, "name", where);
  if (object.contains("node")) part.node = text_at(object, "node", where);
  if (object.contains("pose")) part.pose = pose_at(object, where, largest_deviation);
  return part;
}

AllowedPair allowed_of(const json& object, const std::string& where) {
  check_keys(object, {"parts", "volume"}, where);
  const json names = object.value("parts", json());
  if (!names.is_array() || names.size() != 2 || !names[0].is_string() || !names[1].is_string())
    refuse("\"parts\" is no list of two names", where, "write {\"parts\": [\"shaft\", \"hub\"]}");
  AllowedPair allowed{names[0].get<std::string>(), names[1].get<std::string>(), {}};
  if (!object.contains("volume")) return allowed;
  const json& volume = object["volume"];
  if (!volume.is_number() || !(volume.get<double>() >= 0))
    refuse("\"volume\" is no number of at least 0", where,
           "give the volume that the two may share, in the unit's cube");
  allowed.volume = volume.get<double>();
  return allowed;
}

// Returns the list with this key; an empty one if it is not there.
const json& list_at(const json& object, const char* key, const std::string& where) {
  static const json kNone = json::array();
  if (!object.contains(key)) return kNone;
  if (!object[key].is_array())
    refuse(std::string("\"") + key + "\" is no list", where, "write it in brackets, [ … ]");
  return object[key];
}

std::vector<std::string> names_of(const Assembly& assembly) {
  std::vector<std::string> names;
  for (const AssemblyPart& part : assembly.parts) names.push_back(part.name);
  return names;
}

void check_names_once(const Assembly& assembly) {
  std::map<std::string, std::size_t> place;
  for (std::size_t k = 0; k < assembly.parts.size(); ++k) {
    const auto [first, is_new] = place.try_emplace(assembly.parts[k].name, k);
    if (!is_new)
      refuse("parts " + std::to_string(first->second) + " and " + std::to_string(k) +
                 " have one name, '" + file::shown(first->first) + "'",
             assembly.path, "give each a \"name\" of its own");
  }
}

// Refuses a name that is no part's, with the one that may be meant.
[[noreturn]] void refuse_part(const std::string& name, const std::vector<std::string>& names,
                              const std::string& where) {
  const std::string guess = file::guess_of_word(name, names);
  refuse("there is no part '" + file::shown(name) + "'", where,
         guess.empty() ? "the parts are " + file::listed(names) : guess);
}

// Throws Error(refused) for a rule that names no part.
void check_rules(const Assembly& assembly) {
  const std::vector<std::string> names = names_of(assembly);
  for (std::size_t k = 0; k < assembly.allowed.size(); ++k)
    for (const std::string& name : {assembly.allowed[k].first, assembly.allowed[k].second}) {
      if (std::ranges::any_of(names, [&](const auto& part) { return is_like(part, name); }))
        continue;
      refuse_part(name, names, assembly.path + ", allowed pair " + std::to_string(k));
    }
}

Assembly described(const std::string& path) {
  const std::string name = path == "-" ? "standard input" : path;
  const std::vector<std::byte> bytes = file::read_all(path);
  json all;
  try {
    all = file::parse_json(file::without_byte_order_mark(file::as_text(bytes)));
  } catch (const Error& error) {
    refuse("it is " + error.problem(), name, error.hint());
  }
  check_keys(all, {"parts", "unit", "allowed"}, name);
  Assembly assembly{.path = name, .unit = {}, .parts = {}, .allowed = {}};
  if (all.contains("unit")) {
    assembly.unit = text_at(all, "unit", name);
    if (!metres_of_unit(assembly.unit))
      refuse("\"unit\" is '" + file::shown(assembly.unit) + "'", name,
             "give m, cm, mm, um, in or ft");
  }
  const fs::path folder = path == "-" ? fs::path() : fs::path(path).parent_path();
  for (const json& object : list_at(all, "parts", name))
    assembly.parts.push_back(part_of(object, folder,
                                     name + ", part " + std::to_string(assembly.parts.size()),
                                     assembly.largest_deviation));
  for (const json& object : list_at(all, "allowed", name))
    assembly.allowed.push_back(
        allowed_of(object, name + ", allowed pair " + std::to_string(assembly.allowed.size())));
  return assembly;
}

// True if the file of a folder is a part: hidden files are none. So is a link that leads nowhere,
// which nobody can read.
bool is_part(const fs::directory_entry& entry) {
  const std::string name = entry.path().filename().string();
  std::error_code fault;
  const fs::file_type type = entry.status(fault).type();
  const bool may_be_read = type == fs::file_type::regular || type == fs::file_type::not_found;
  if (name.starts_with('.') || !may_be_read) return false;
  return has_mesh_ending(name) || file::in_lower_case(entry.path().extension().string()) == ".vpmg";
}

// Returns how many parts stand in folders of the folder that are not hidden.
std::size_t parts_below(const std::string& path) {
  std::size_t count = 0;
  std::error_code fault;
  fs::recursive_directory_iterator entry(path, fs::directory_options::skip_permission_denied,
                                         fault);
  for (; !fault && entry != fs::recursive_directory_iterator(); entry.increment(fault)) {
    if (entry->path().filename().string().starts_with('.'))
      entry.disable_recursion_pending();
    else if (entry.depth() > 0 && is_part(*entry))
      ++count;
  }
  return count;
}

Assembly listed(const Program& program, const std::string& path) {
  Assembly assembly{.path = path, .unit = {}, .parts = {}, .allowed = {}};
  std::error_code fault;
  for (const fs::directory_entry& entry : fs::directory_iterator(path, fault))
    if (is_part(entry))
      assembly.parts.push_back({entry.path().filename().string(), entry.path().string(), {}, {}});
  if (fault) refuse("cannot read " + path + ": " + fault.message());
  std::ranges::sort(assembly.parts, {}, &AssemblyPart::name);
  if (const std::size_t below = parts_below(path); below > 0)
    program.note(path + ": " + std::to_string(below) +
                 (below == 1 ? " part in its folders is" : " parts in its folders are") +
                 " left out, since a folder's own files are its parts");
  return assembly;
}

}  // namespace

bool AllowedPair::holds(const std::string& a, const std::string& b) const {
  return (is_like(a, first) && is_like(b, second)) || (is_like(b, first) && is_like(a, second));
}

const AllowedPair* Assembly::rule_for(const AssemblyPart& a, const AssemblyPart& b) const {
  const auto rule = std::ranges::find_if(
      allowed, [&](const AllowedPair& pair) { return pair.holds(a.name, b.name); });
  return rule == allowed.end() ? nullptr : &*rule;
}

Assembly read_assembly(const Program& program, const std::string& path) {
  std::error_code fault;
  if (path != "-" && is_mesh_file(path))
    refuse_usage("--pairs " + path +
                 " is a mesh: give the folder of all parts, or a description (assembly.json)");
  Assembly assembly = fs::is_directory(path, fault) ? listed(program, path) : described(path);
  if (assembly.parts.size() < 2)
    refuse(assembly.parts.empty() ? "there is no part" : "there is one part only", assembly.path,
           "an assembly has two closed meshes (.stl, .obj, .ply, …) or models (.vpmg) at least, "
           "each in a file of its own");
  check_names_once(assembly);
  check_rules(assembly);
  return assembly;
}

void place_parts(Assembly& assembly, const std::string& poses) {
  PoseReader reader(poses);
  const std::vector<std::string> names = names_of(assembly);
  std::set<std::string> placed;
  while (const std::optional<Pose> pose = reader.next()) {
    const json id = reader.id().empty() ? json() : json::parse(reader.id());
    if (!id.is_string())
      refuse("the pose has no \"id\" that names its part", reader.place(),
             "write {\"id\": \"" + names.front() + "\", \"pose\": […]}");
    const auto name = id.get<std::string>();
    const auto part = std::ranges::find(assembly.parts, name, &AssemblyPart::name);
    if (part == assembly.parts.end()) refuse_part(name, names, reader.place());
    if (!placed.insert(name).second)
      refuse("the part '" + file::shown(name) + "' has two poses", reader.place(),
             "leave one of them out");
    part->pose = *pose;
  }
  if (placed.empty()) reader.refuse_empty();
  assembly.largest_deviation = std::max(assembly.largest_deviation, reader.largest_deviation());
}

}  // namespace vpm::tools
