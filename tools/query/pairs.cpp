#include "tools/query/pairs.h"

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "libvpm/file/stream.h"
#include "tools/common/error_text.h"
#include "tools/common/length_units.h"
#include "tools/common/recorded_frames.h"
#include "tools/common/repair_option.h"
#include "tools/query/contact_lines.h"
#include "tools/query/pairs_assembly.h"
#include "tools/query/pairs_parts.h"
#include "tools/query/result_output.h"

namespace vpm::tools {
namespace {

constexpr CsvColumn kPairs[] = {
    {"part_a", "/parts/0"},        {"part_b", "/parts/1"},
    {"volume", "/volume"},         {"volume_fraction", "/volume_fraction"},
    {"centroid_x", "/centroid/0"}, {"centroid_y", "/centroid/1"},
    {"centroid_z", "/centroid/2"}, {"closure", "/closure"},
    {"contacts", "/contacts"},     {"allowed", "/allowed"},
    {"above", "/above"},           {"unit", "/unit"},
};

// Returns the unit of the assembly: that of --unit, or that of its description; metres otherwise.
std::string unit_of(const Arguments& a, const Assembly& assembly) {
  if (!a.unit.empty() && !assembly.unit.empty() && a.unit != assembly.unit)
    refuse_usage("--unit " + a.unit + ", but " + assembly.path + " is in " + assembly.unit +
                 ": leave --unit out");
  return !a.unit.empty() ? a.unit : !assembly.unit.empty() ? assembly.unit : "m";
}

SolidOptions solid_options_of(const Arguments& a, const Assembly& assembly, double metres) {
  SolidOptions options;
  if (!a.unit.empty() || !assembly.unit.empty()) options.scale = metres;
  if (!a.repair.empty() && !parse_repair(a.repair, options))
    refuse_usage("--repair " + a.repair + ": give holes, voxel, voxel=RES, flood or flood=RES");
  return options;
}

// An assembly whose pairs are told, in its unit.
class PairLines {
 public:
  PairLines(const Arguments& arguments, const Assembly& assembly, const PreparedParts& prepared,
            const std::string& unit)
      : arguments_(arguments), assembly_(assembly), prepared_(prepared), unit_(unit) {}

  void add(const OverlappingPair& pair) {
    const AssemblyPart &a = part(pair.first), &b = part(pair.second);
    const double metres = metres_of_unit(unit_).value(), cube = metres * metres * metres;
    const double volume = pair.overlap.volume / cube;
    const double smaller = std::min(solid(pair.first).volume(), solid(pair.second).volume()) / cube;
    const auto [x, y, z] = pair.overlap.centroid;
    nlohmann::ordered_json line{{"parts", {a.name, b.name}},
                                {"volume", volume},
                                {"volume_fraction", volume / smaller},
                                {"centroid", {x / metres, y / metres, z / metres}},
                                {"closure", pair.overlap.closure}};
    const AllowedPair* const rule = assembly_.rule_for(a, b);
    if (arguments_.contacts > 0) line["contacts"] = contacts_of_pair(pair.overlap.contacts, metres);
    if (rule != nullptr && rule->volume) line["allowed"] = *rule->volume;
    if (rule != nullptr && !rule->volume) line["allowed"] = "any";
    if (arguments_.fail_above) line["above"] = is_above(line, rule, smaller);
    line["unit"] = unit_;
    lines_.push_back(std::move(line));
  }

  const std::vector<nlohmann::ordered_json>& lines() const { return lines_; }
  // Returns a sentence for each pair above its limit.
  const std::vector<std::string>& above() const { return above_; }

 private:
  const AssemblyPart& part(std::size_t k) const { return assembly_.parts[prepared_.places[k]]; }
  const SolidBody& solid(std::size_t k) const { return prepared_.parts[k].solid; }

  // True if the pair of a line shares more than it may. Volumes are right to 1e-9 of the smaller
  // solid, so a limit that is met exactly holds.
  bool is_above(const nlohmann::ordered_json& line, const AllowedPair* rule, double smaller) {
    if (rule != nullptr && !rule->volume) return false;
    const double limit = rule != nullptr ? *rule->volume : *arguments_.fail_above;
    const double volume = line["volume"].get<double>();
    if (volume <= limit + (limit > 0 ? 1e-9 * smaller : 0)) return false;
    char text[80];
    std::snprintf(text, sizeof text, " share %.6g %s³, above %.6g", volume, unit_.c_str(), limit);
    above_.push_back("'" + line["parts"][0].get<std::string>() + "' and '" +
                     line["parts"][1].get<std::string>() + "'" + text);
    return true;
  }

  const Arguments& arguments_;
  const Assembly& assembly_;
  const PreparedParts& prepared_;
  const std::string unit_;
  std::vector<nlohmann::ordered_json> lines_;
  std::vector<std::string> above_;
};

std::string counted(std::size_t count, const std::string& what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

// Says how many pairs there are, and which are above their limits, the first of many.
void say(const Program& program, const PairLines& pairs, std::size_t parts) {
  constexpr std::size_t kMost = 20;
  const std::size_t found = pairs.lines().size(), above = pairs.above().size();
  for (std::size_t k = 0; k < std::min(above, kMost); ++k) program.note(pairs.above()[k]);
  if (above > kMost) program.note(std::to_string(above - kMost) + " more pairs are above");
  program.note(counted(parts, "part") + ", " + counted(found, "pair") +
               (found == 1 ? " shares volume" : " share volume"));
}

// Returns how many pairs cannot be answered, and prints why.
std::size_t say_refusals(const Program& program, const Assembly& assembly,
                         const PreparedParts& prepared, const std::vector<OverlappingPair>& found) {
  std::size_t refused = 0;
  for (const OverlappingPair& pair : found) {
    if (pair.refusal.empty()) continue;
    ++refused;
    program.error("no answer for '" + assembly.parts[prepared.places[pair.first]].name + "' and '" +
                  assembly.parts[prepared.places[pair.second]].name + "': " + pair.refusal);
  }
  return refused;
}

}  // namespace

void run_pairs(Program& program, const Arguments& a) {
  // Most assemblies take less time than a device to begin, so one must be named.
  const Device device = program.common().device == "auto" ? Device{} : program.device();
  Assembly assembly = read_assembly(program, a.pairs);
  if (!a.poses.empty()) place_parts(assembly, a.poses.front());
  note_deviation(program, assembly.path, assembly.largest_deviation);
  const std::string unit = unit_of(a, assembly);
  const double metres = metres_of_unit(unit).value();
  const PreparedParts prepared = prepare_parts(
      program, assembly, metres, solid_options_of(a, assembly, metres), a.contacts > 0);
  const std::vector<OverlappingPair> found =
      overlapping_pairs(prepared.parts, {.with_force = a.contacts > 0,
                                         .contacts = static_cast<std::uint32_t>(a.contacts),
                                         .device = device});
  PairLines pairs(a, assembly, prepared, unit);
  for (const OverlappingPair& pair : found)
    if (pair.refusal.empty()) pairs.add(pair);
  write_lines(a.output, kPairs, pairs.lines());
  const std::size_t refused = say_refusals(program, assembly, prepared, found);
  say(program, pairs, prepared.parts.size());
  const std::size_t left_out = assembly.parts.size() - prepared.parts.size();
  if (!pairs.above().empty()) return program.end_with(10);
  if (left_out > 0)
    throw Error(ErrorKind::refused,
                std::to_string(left_out) + " of " + counted(assembly.parts.size(), "part") +
                    (left_out == 1 ? " is" : " are") + " left out for what is said above");
  if (refused > 0)
    throw Error(ErrorKind::refused, counted(refused, "pair") + (refused == 1 ? " has" : " have") +
                                        " no answer for what is said above");
}

}  // namespace vpm::tools
