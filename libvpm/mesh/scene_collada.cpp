// The asset of COLLADA files: their unit and axes, and what of them is not applied.
#include <cmath>

#include "libvpm/core/error.h"
#include "libvpm/file/text.h"
#include "libvpm/mesh/scene_header.h"
#include "libvpm/mesh/xml_elements.h"

namespace vpm {
namespace {

// Takes the length of the file's unit.
void take_unit(const XmlElement& element, const std::string& name, ColladaHeader& header) {
  const auto word = element.attribute("meter");
  if (!word) {
    header.unit_name = element.text_of("name");
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

}  // namespace

ColladaHeader collada_header(std::string_view text, const std::string& name) {
  ColladaHeader header;
  bool has_asset = false, has_unit = false, has_axis = false;
  XmlEvents events;
  events.begin = [&](const XmlElement& element) {
    if (element.name() == "morph") header.has_morph = true;
    if (element.name() != "unit" || !element.is_in({"COLLADA", "asset"}) || has_unit) return;
    take_unit(element, name, header);
    has_unit = true;
  };
  events.end = [&](const XmlElement& element, std::string_view axis) {
    if (element.depth() == 1 && element.name() == "asset") has_asset = true;
    if (element.name() != "up_axis" || !element.is_in({"COLLADA", "asset"}) || has_axis) return;
    header.up = axis == "Z_UP" ? 'z' : axis == "X_UP" ? 'x' : 'y';
    has_axis = true;
  };
  const auto fault = read_xml(text, events);
  // Leaves it to assimp to judge what is wrong behind the asset.
  if (fault && !has_asset) {
    refuse("its unit cannot be read, as its XML is damaged: " + *fault, name,
           "save it again, or as OBJ, PLY or STL");
  }
  return header;
}

}  // namespace vpm
