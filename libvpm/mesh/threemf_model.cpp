#include "libvpm/mesh/threemf_model.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "libvpm/core/error.h"
#include "libvpm/file/text.h"
#include "libvpm/mesh/mesh_parsers.h"
#include "libvpm/mesh/xml_elements.h"

namespace vpm {
namespace {

void take_unit(const XmlElement& root, const std::string& name, ThreemfModel& model) {
  const auto unit = root.attribute("unit");
  if (!unit) return;
  constexpr std::array<std::pair<const char*, double>, 6> kUnits = {{{"micron", 1e-6},
                                                                     {"millimeter", 0.001},
                                                                     {"centimeter", 0.01},
                                                                     {"inch", 0.0254},
                                                                     {"foot", 0.3048},
                                                                     {"meter", 1}}};
  for (const auto& [known, metres] : kUnits) {
    if (*unit != known) continue;
    model.unit = known;
    model.metres = metres;
    return;
  }
  refuse("its unit '" + file::shown(*unit) +
             "' is none of 3MF: micron, millimeter, centimeter, inch, foot or meter",
         name);
}

// Refuses extensions that the model requires and that are not known. Objects that depend on the
// known ones are refused where the build places them.
void check_required(const XmlElement& root, const std::string& name) {
  constexpr std::array kKnown{"/production/", "/material/", "/trianglesets/", "/slice/",
                              "/beamlattice/"};
  for (const std::string_view prefix : file::split_words(root.text_of("requiredextensions"))) {
    const std::string_view space = root.attribute(prefix).value_or(prefix);
    if (std::any_of(kKnown.begin(), kKnown.end(),
                    [&](const char* part) { return space.find(part) != space.npos; }))
      continue;
    refuse("it requires the 3MF extension " + file::shown(space, 100) + ", which is not read here",
           name, kExport);
  }
}

// Reads the elements of a model one after the other.
class ModelReader {
 public:
  ModelReader(const std::string& name, ThreemfModel& model) : name_(name), model_(model) {}

  void begin(const XmlElement& element);
  void end(const XmlElement& element, std::string_view text);

 private:
  void begin_object(const XmlElement& element);
  void take_part_of_mesh(const XmlElement& element);
  void take_vertex(const XmlElement& element);
  void take_triangle(const XmlElement& element);
  void take_item(const XmlElement& element);
  void take_setting(std::string_view value);
  ThreemfComponent component(const XmlElement& element) const;
  std::uint64_t count(const XmlElement& element, std::string_view attribute) const;
  void check_triangles() const;

  const std::string& name_;
  ThreemfModel& model_;
  ThreemfObject* object_ = nullptr;
  std::string setting_;  // name of the metadata that is being read
};

std::uint64_t ModelReader::count(const XmlElement& element, std::string_view attribute) const {
  const std::string word = element.text_of(attribute);
  if (const auto number = file::to_count(word)) return *number;
  refuse("the attribute " + std::string(attribute) + " of a " + file::shown(element.name()) +
             " is '" + file::shown(word) + "', which is no index",
         name_, kSaveAgain);
}

ThreemfComponent ModelReader::component(const XmlElement& element) const {
  ThreemfComponent component{element.text_of("path"), count(element, "objectid"), {}};
  const auto transform = element.attribute("transform");
  if (!transform) return component;
  std::vector<double> m;
  for (const std::string_view word : file::split_words(*transform)) {
    const auto number = file::to_number(word);
    if (number) m.push_back(*number);
  }
  Pose& place = component.place;
  if (m.size() == 12) {  // three columns of the matrix, then the translation
    place.rotation = {{m[0], m[3], m[6]}, {m[1], m[4], m[7]}, {m[2], m[5], m[8]}};
    place.translation = {m[9], m[10], m[11]};
  }
  const Rotation& r = place.rotation;
  if (m.size() != 12 || !is_finite(r.row0 + r.row1 + r.row2 + place.translation)) {
    refuse("the transform '" + file::shown(*transform, 120) + "' is not of 12 numbers", name_,
           kSaveAgain);
  }
  return component;
}

void ModelReader::begin_object(const XmlElement& element) {
  const std::uint64_t id = count(element, "id");
  const auto [place, is_new] = model_.objects.try_emplace(id);
  if (!is_new) refuse("two objects have the id " + std::to_string(id), name_, kSaveAgain);
  object_ = &place->second;
  object_->name = element.text_of("name");
  object_->role = element.text_of("type");
  // Meshes that only stand for slices, or for a finer mesh elsewhere.
  for (const char* const resolution : {"meshresolution", "modelresolution"}) {
    const std::string word = element.text_of(resolution);
    if (!word.empty() && word != "fullres")
      object_->unread = "another representation than its mesh";
  }
}

void ModelReader::take_vertex(const XmlElement& element) {
  const auto number = [&](const char* axis) {
    const std::string word = element.text_of(axis);
    const auto value = file::to_number(word);
    if (value) return *value;
    refuse(std::string("the coordinate ") + axis + " of a vertex is '" + file::shown(word) +
               "', which is no number",
           name_, kSaveAgain);
  };
  const Vec3 vertex{number("x"), number("y"), number("z")};
  if (!is_finite(vertex)) refuse("a coordinate is not finite", name_);
  object_->vertices.push_back(vertex);
}

void ModelReader::take_triangle(const XmlElement& element) {
  Triangle triangle{};
  for (std::size_t k = 0; k < 3; ++k) {
    constexpr std::array<const char*, 3> kCorners = {"v1", "v2", "v3"};
    const std::uint64_t vertex = count(element, kCorners[k]);
    triangle[k] = static_cast<std::uint32_t>(std::min<std::uint64_t>(vertex, 0xFFFFFFFF));
  }
  object_->triangles.push_back(triangle);
}

// Takes an element in a mesh, where Slic3r tells which triangles are modifiers.
void ModelReader::take_part_of_mesh(const XmlElement& element) {
  if (element.is_in({"mesh", "vertices"}) && element.name() == "vertex") {
    take_vertex(element);
  } else if (element.is_in({"mesh", "triangles"}) && element.name() == "triangle") {
    take_triangle(element);
  } else if (element.is_in({"mesh", "volumes"}) && element.name() == "volume") {
    object_->volumes.push_back({count(element, "ts"), count(element, "te"),
                                element.text_of("modifier") == "1" ? "modifier" : ""});
  } else if (element.is_in({"object", "mesh"})) {
    constexpr std::array kKnown{"vertices", "triangles", "trianglesets", "volumes"};
    if (element.name() == "beamlattice") {
      object_->unread = "a beam lattice";
    } else if (std::find(kKnown.begin(), kKnown.end(), element.name()) == kKnown.end()) {
      object_->ignored = element.name();
    }
  }
}

void ModelReader::take_item(const XmlElement& element) {
  const std::string printable = element.text_of("printable");
  model_.build.push_back({component(element), "", printable != "0" && printable != "false"});
}

void ModelReader::begin(const XmlElement& element) {
  const std::string& name = element.name();
  if (element.depth() == 0) {
    if (name != "model") {
      refuse("its model begins with the element " + file::shown(name) + ", not model", name_,
             kSaveAgain);
    }
    take_unit(element, name_, model_);
    check_required(element, name_);
  } else if (name == "object" && element.is_in({"model", "resources"})) {
    begin_object(element);
  } else if (name == "item" && element.is_in({"model", "build"})) {
    take_item(element);
  } else if (object_ != nullptr && name == "component" && element.is_in({"object", "components"})) {
    object_->components.push_back(component(element));
  } else if (object_ != nullptr && element.is_in({"resources", "object"})) {
    constexpr std::array kKnown{"mesh", "components", "metadatagroup", "settings"};
    if (std::find(kKnown.begin(), kKnown.end(), name) == kKnown.end()) object_->ignored = name;
  } else if (object_ != nullptr && (name == "metadata" || name == "setting")) {
    setting_ = element.text_of(name == "metadata" ? "name" : "key");
  } else if (name == "metadata" && element.is_in({"build", "item", "metadatagroup"})) {
    setting_ = element.text_of("name");
  } else if (object_ != nullptr) {
    take_part_of_mesh(element);
  }
}

// Cura tells in settings of an object that it is no part of the solid, in its own words.
void ModelReader::take_setting(std::string_view value) {
  const std::string key = setting_.substr(setting_.rfind(':') + 1);
  const bool is_mesh = key == "support_mesh" || key == "anti_overhang_mesh" ||
                       key == "infill_mesh" || key == "cutting_mesh";
  const bool is_set = file::is_word(value, "true") || file::is_word(value, "1");
  if (is_mesh && is_set)
    (object_ != nullptr ? object_->setting : model_.build.back().setting) = key;
  setting_.clear();
}

void ModelReader::end(const XmlElement& element, std::string_view text) {
  if (!setting_.empty()) take_setting(text);
  if (object_ == nullptr) return;
  if (element.name() != "object" || !element.is_in({"model", "resources"})) return;
  check_triangles();
  const bool has_shape = !object_->triangles.empty() || !object_->components.empty();
  if (!has_shape && !object_->ignored.empty() && object_->unread.empty())
    object_->unread = "'" + file::shown(object_->ignored) + "'";
  object_ = nullptr;
}

void ModelReader::check_triangles() const {
  for (const Triangle& triangle : object_->triangles)
    for (const std::uint32_t vertex : triangle)
      if (vertex >= object_->vertices.size()) refuse("a vertex index is out of range", name_);
}

}  // namespace

ThreemfModel threemf_model(std::string_view xml, const std::string& name) {
  ThreemfModel model;
  ModelReader reader(name, model);
  const auto fault = read_xml(
      xml, {[&](const XmlElement& element) { reader.begin(element); },
            [&](const XmlElement& element, std::string_view text) { reader.end(element, text); }});
  if (fault) refuse("the XML of its model is damaged: " + *fault, name, kSaveAgain);
  return model;
}

}  // namespace vpm
