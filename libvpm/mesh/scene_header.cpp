#include "libvpm/mesh/scene_header.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "libvpm/core/error.h"
#include "libvpm/file/text.h"
#include "libvpm/mesh/scene_archive.h"
#include "libvpm/mesh/scene_xml.h"

namespace vpm {
namespace {

constexpr const char* kExport = "export it as STL or OBJ";

// Takes the length of COLLADA's unit.
void take_unit(const XmlTags& tag, const std::string& name, ColladaHeader& header) {
  const auto word = tag.attribute("meter");
  if (!word) {
    header.unit_name = tag.attribute("name").value_or("");
    return;
  }
  const auto metres = file::to_number(*word);
  if (!metres || !(*metres > 0) || !std::isfinite(*metres)) {
    refuse(
        "its unit has the length meter=\"" + file::shown(*word) + "\", which is no positive number",
        name, "write the metres of one unit there, 0.001 for millimetres");
  }
  header.metres = metres;
}

// Returns the main model in a 3MF archive: that which its relationships name, otherwise that of the
// usual name, otherwise any.
std::string main_model(std::string_view zip) {
  const std::vector<ZipEntry> entries = zip_entries(zip);
  const auto find = [&](std::string_view path) {
    return std::find_if(entries.begin(), entries.end(),
                        [&](const ZipEntry& entry) { return entry.path == path; });
  };
  auto model = entries.end();
  if (const auto list = find("_rels/.rels"); list != entries.end()) {
    const std::string text = unpacked(zip, *list);
    for (XmlTags tag(text); model == entries.end() && tag.next();) {
      if (tag.name() != "Relationship" || !tag.attribute("Type").value_or("").ends_with("/3dmodel"))
        continue;
      std::string target = file::in_lower_case(tag.attribute("Target").value_or(""));
      if (target.starts_with('/')) target.erase(0, 1);
      model = find(target);
    }
  }
  if (model == entries.end()) model = find("3d/3dmodel.model");
  if (model == entries.end()) {
    model = std::find_if(entries.begin(), entries.end(),
                         [](const ZipEntry& entry) { return entry.path.ends_with(".model"); });
  }
  return model == entries.end() ? "" : unpacked(zip, *model);
}

// Returns the unit that the model's root element names.
std::optional<NamedUnit> unit_of_model(const XmlTags& root, const std::string& name) {
  const auto unit = root.attribute("unit");
  if (!unit) return std::nullopt;
  constexpr std::array<std::pair<const char*, double>, 6> kUnits = {{{"micron", 1e-6},
                                                                     {"millimeter", 0.001},
                                                                     {"centimeter", 0.01},
                                                                     {"inch", 0.0254},
                                                                     {"foot", 0.3048},
                                                                     {"meter", 1}}};
  for (const auto& [known, metres] : kUnits)
    if (*unit == known) return NamedUnit{known, metres};
  refuse("its unit '" + file::shown(*unit) +
             "' is none of 3MF: micron, millimeter, centimeter, inch, foot or meter",
         name);
}

// Refuses extensions that the model requires and that may change its bodies. Parts in other files,
// which the production extension allows, are refused where they are.
void check_required(const XmlTags& root, const std::string& name) {
  for (const std::string_view prefix :
       file::split_words(root.attribute("requiredextensions").value_or(""))) {
    const std::string_view space = root.attribute("xmlns:" + std::string(prefix)).value_or(prefix);
    const auto is_for = [&](const char* part) { return space.find(part) != space.npos; };
    if (is_for("/production/") || is_for("/material/") || is_for("/trianglesets/")) continue;
    refuse("it requires the 3MF extension " + file::shown(space, 100) + ", which is not read here",
           name, kExport);
  }
}

// Refuses bodies that are not read, given a start tag and the name of the element around it; notes
// what a mesh has besides its triangles.
void check_body(const XmlTags& tag, std::string_view parent, const std::string& name,
                std::vector<std::string>& notes) {
  const std::string_view element = tag.name();
  const auto is_one_of = [&](const auto& names) {
    return std::find(names.begin(), names.end(), element) != names.end();
  };
  using Names = std::initializer_list<std::string_view>;
  if ((element == "component" || element == "item") && tag.prefixed_attribute("path")) {
    refuse(
        "its parts lie in other files of the archive (production extension), which are not read "
        "here",
        name, kExport);
  }
  if (parent == "object" && !is_one_of(Names{"mesh", "components", "metadatagroup"})) {
    refuse("one of its objects is of '" + file::shown(element) +
               "', which is not read here, only meshes are",
           name, kExport);
  }
  if (parent != "mesh" || is_one_of(Names{"vertices", "triangles", "trianglesets"})) return;
  const std::string note = "a mesh has '" + file::shown(element) + "', which is not applied";
  if (std::find(notes.begin(), notes.end(), note) == notes.end()) notes.push_back(note);
}

}  // namespace

ColladaHeader collada_header(std::string_view text, const std::string& name) {
  ColladaHeader header;
  bool in_asset = false, has_unit = false, has_axis = false;
  for (XmlTags tag(text); tag.next();) {
    if (tag.depth() == 1) in_asset = !tag.is_end() && tag.name() == "asset";
    if (tag.is_end()) continue;
    if (tag.name() == "morph") header.has_morph = true;
    if (!in_asset || tag.depth() != 2) continue;
    if (tag.name() == "unit" && !has_unit) {
      take_unit(tag, name, header);
      has_unit = true;
    } else if (tag.name() == "up_axis" && !has_axis) {
      header.up = tag.text() == "Z_UP" ? 'z' : tag.text() == "X_UP" ? 'x' : 'y';
      has_axis = true;
    }
  }
  return header;
}

ThreemfHeader threemf_header(std::string_view bytes, const std::string& name) {
  const std::string model = main_model(bytes);
  ThreemfHeader header;
  XmlTags tag(model);
  if (!tag.next() || tag.name() != "model")
    refuse("no 3D model in UTF-8 can be unpacked from it; it is damaged, or another zip archive",
           name, "save it again, or as OBJ, PLY or STL");
  header.unit = unit_of_model(tag, name);
  check_required(tag, name);
  std::array<std::string_view, 5> around;  // names of the elements by depth; bodies lie no deeper
  while (tag.next()) {
    if (tag.is_end() || tag.depth() == 0 || tag.depth() >= around.size()) continue;
    around[tag.depth()] = tag.name();
    check_body(tag, around[tag.depth() - 1], name, header.notes);
  }
  return header;
}

}  // namespace vpm
