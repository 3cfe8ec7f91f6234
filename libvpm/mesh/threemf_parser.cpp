// 3MF files: the model parts of the package, and what slicers tell of them. All other parts of the
// package (thumbnails, settings, slices, toolpaths) are left alone.
#include <cstdio>
#include <map>
#include <new>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "libvpm/core/error.h"
#include "libvpm/file/stream.h"
#include "libvpm/file/text.h"
#include "libvpm/mesh/mesh_parsers.h"
#include "libvpm/mesh/scene_archive.h"
#include "libvpm/mesh/scene_nodes.h"
#include "libvpm/mesh/threemf_model.h"
#include "libvpm/mesh/threemf_slicers.h"
#include "libvpm/mesh/xml_elements.h"

namespace vpm {
namespace {

// Returns the path of the main model: that which the package's relationships name, otherwise that
// of the usual name, otherwise any.
std::string main_model_of(ZipArchive& archive) {
  std::string path;
  if (const auto list = archive.unpacked("_rels/.rels")) {
    read_xml(*list, {[&](const XmlElement& element) {
                       if (element.name() != "Relationship" || !path.empty() ||
                           !element.text_of("Type").ends_with("/3dmodel"))
                         return;
                       const std::string target = element.text_of("Target");
                       if (archive.has(target)) path = target;
                     },
                     {}});
  }
  if (path.empty() && archive.has("3D/3dmodel.model")) path = "3D/3dmodel.model";
  return path.empty() ? archive.path_ending_in(".model") : path;
}

// Takes triangles that are no part of the solid out of the object, with the vertices that only they
// have.
void drop_volumes(ThreemfObject& object) {
  std::vector<bool> is_dropped(object.triangles.size());
  bool drops_any = false;
  for (const ThreemfVolume& volume : object.volumes) {
    if (role_of(volume.role) == ThreemfRole::solid) continue;
    for (std::size_t k = volume.first; k < is_dropped.size() && k <= volume.last; ++k)
      drops_any = is_dropped[k] = true;
  }
  if (!drops_any) return;
  constexpr std::uint32_t kDropped = 0xFFFFFFFF;
  std::vector<std::uint32_t> index(object.vertices.size(), kDropped);
  ThreemfObject kept;
  for (std::size_t k = 0; k < is_dropped.size(); ++k) {
    if (is_dropped[k]) continue;
    Triangle triangle = object.triangles[k];
    for (std::uint32_t& vertex : triangle) {
      if (index[vertex] == kDropped) {
        index[vertex] = static_cast<std::uint32_t>(kept.vertices.size());
        kept.vertices.push_back(object.vertices[vertex]);
      }
      vertex = index[vertex];
    }
    kept.triangles.push_back(triangle);
  }
  object.vertices = std::move(kept.vertices);
  object.triangles = std::move(kept.triangles);
}

// Places the objects of the build.
class Placement {
 public:
  Placement(std::string_view bytes, const std::string& name)
      : name_(name), most_(file::most_memory(bytes.size())), archive_(bytes) {}

  RawMesh mesh(const std::string& node);

 private:
  const ThreemfModel& part(const std::string& path);
  void place(const ThreemfModel& model, const ThreemfComponent& component, std::size_t parent,
             const Pose& to_world, const std::string& slicers_word);
  bool is_solid(const ThreemfObject& object, const std::string& slicers_word);
  void add(std::size_t node, RawMesh& mesh) const;
  void add_notes(RawMesh& mesh) const;

  const std::string& name_;
  std::uint64_t most_;  // bytes that the mesh may take
  ZipArchive archive_;
  SlicerSettings settings_;
  std::string key_store_;  // XML in lower case that names the parts that are encrypted
  std::map<std::string, ThreemfModel> parts_;
  const ThreemfModel* main_ = nullptr;
  std::vector<SceneNode> nodes_{{"", 0, false}};
  struct Placed {
    const ThreemfObject* object;
    Pose to_world;
  };
  std::vector<Placed> placed_{{nullptr, {}}};  // one for each node
  std::size_t depth_ = 0, visits_ = 0;
  std::map<std::string, std::size_t> left_out_;  // counts of parts by their roles
  std::size_t unprinted_ = 0;                    // items of the build that are left out
};

// Returns the model part of the package, which is read once.
const ThreemfModel& Placement::part(const std::string& path_as_written) {
  const std::string path = ZipArchive::key_of(path_as_written);
  if (const auto known = parts_.find(path); known != parts_.end()) return known->second;
  const auto text = archive_.unpacked(path);
  const bool is_encrypted = key_store_.find(path) != key_store_.npos;
  if (!text || is_encrypted) {
    const std::string part = "its model part '" + file::shown(path_as_written) + "' ";
    refuse(part + (!archive_.has(path) ? "is not in the file"
                   : is_encrypted      ? "is encrypted"
                                       : "cannot be unpacked"),
           name_, is_encrypted ? kExport : kSaveAgain);
  }
  ThreemfModel& model = parts_[path] = threemf_model(*text, name_);
  if (main_ == nullptr) {
    for (const auto& [id, volumes] : settings_.volumes)
      if (const auto object = model.objects.find(id); object != model.objects.end())
        object->second.volumes = volumes;
  } else if (!model.unit.empty() && model.metres != main_->metres) {
    refuse("its model part '" + file::shown(path_as_written) + "' has another unit, " + model.unit +
               ", than its main model",
           name_, kExport);
  }
  for (auto& [id, object] : model.objects) drop_volumes(object);
  return model;
}

// Tells whether an object is part of the solid, and counts those that are not. The slicer's word
// counts more than that of the model, where the type of an object of components says nothing.
bool Placement::is_solid(const ThreemfObject& object, const std::string& slicers_word) {
  const auto check = [&](const std::string& word) {
    const ThreemfRole role = role_of(word);
    if (role == ThreemfRole::left_out) ++left_out_[word];
    if (role != ThreemfRole::cut_away) return role == ThreemfRole::solid;
    const std::string part =
        object.name.empty() ? "a part" : "a part '" + file::shown(object.name) + "'";
    refuse("it has " + part + " of the type " + file::shown(word) +
               ", which would have to be cut away and is not here",
           name_, "export the plate or object as STL, which the slicer cuts");
  };
  const bool is_mesh = object.components.empty();
  const std::string& own_word = !object.setting.empty() || !is_mesh ? object.setting : object.role;
  if (!check(slicers_word.empty() ? own_word : slicers_word)) return false;
  for (const ThreemfVolume& volume : object.volumes) check(volume.role);
  return true;
}

void Placement::place(const ThreemfModel& model, const ThreemfComponent& component,
                      std::size_t parent, const Pose& to_world, const std::string& slicers_word) {
  constexpr std::size_t kMostDeep = 64, kBytesOfVisit = 256;
  if (++depth_ > kMostDeep || ++visits_ > most_ / kBytesOfVisit) {
    refuse("its components are nested without end, or too often for a file of this size", name_,
           kSaveAgain);
  }
  const ThreemfModel& holder = component.path.empty() ? model : part(component.path);
  const auto found = holder.objects.find(component.object);
  if (found == holder.objects.end())
    refuse("it has no object " + std::to_string(component.object) + ", which is placed", name_,
           kSaveAgain);
  const ThreemfObject& object = found->second;
  if (is_solid(object, slicers_word)) {
    if (!object.unread.empty()) {
      refuse(
          "one of its objects is of " + object.unread + ", which is not read here, only meshes are",
          name_, kExport);
    }
    const std::size_t at = nodes_.size();
    const std::string id = std::to_string(component.object);
    nodes_.push_back(
        {object.name.empty() ? "object " + id : object.name, parent, !object.triangles.empty()});
    const Pose here = to_world * component.place;
    placed_.push_back({&object, here});
    for (const ThreemfComponent& below : object.components) {
      const auto word = settings_.parts.find({component.object, below.object});
      const bool has_word = &holder == main_ && word != settings_.parts.end();
      place(holder, below, at, here, has_word ? word->second : "");
    }
  }
  --depth_;
}

// Appends the triangles of a node; a mirrored one is turned over, as its surface is.
void Placement::add(std::size_t node, RawMesh& mesh) const {
  const auto& [object, to_world] = placed_[node];
  const std::size_t first = mesh.vertices.size();
  constexpr std::size_t kBytesOfTriangle = 3 * sizeof(std::uint32_t) + sizeof(std::size_t);
  if (first + object->vertices.size() > kMaxVertices ||
      (first + object->vertices.size()) * sizeof(Vec3) +
              (mesh.polygon_count() + object->triangles.size()) * kBytesOfTriangle >
          most_)
    throw std::bad_alloc();
  for (const Vec3& vertex : object->vertices) {
    mesh.vertices.push_back(main_->metres * (to_world * vertex));
    if (!is_finite(mesh.vertices.back())) refuse("a coordinate is not finite", name_);
  }
  const Rotation& r = to_world.rotation;
  const bool is_mirrored = dot(r.row0, cross(r.row1, r.row2)) < 0;
  for (const Triangle& t : object->triangles) {
    for (const std::uint32_t vertex : {t[0], t[is_mirrored ? 2 : 1], t[is_mirrored ? 1 : 2]})
      mesh.corners.push_back(static_cast<std::uint32_t>(first + vertex));
    mesh.end_polygon();
  }
}

void Placement::add_notes(RawMesh& mesh) const {
  std::size_t count = unprinted_;
  std::string words;
  for (const auto& [word, parts] : left_out_) {
    words += (words.empty() ? "" : ", ") + file::shown(word);
    count += parts;
  }
  if (unprinted_ > 0) words += (words.empty() ? "" : ", ") + std::string("not printable");
  if (count > 0) {
    mesh.notes.push_back(std::to_string(count) + (count == 1 ? " part is" : " parts are") +
                         " left out as no part of the solid: " + words);
  }
  std::map<std::string, bool> ignored;
  for (const Placed& placed : placed_)
    if (placed.object != nullptr && !placed.object->ignored.empty())
      ignored[placed.object->ignored] = true;
  for (const auto& [element, is_there] : ignored)
    mesh.notes.push_back("an object has '" + file::shown(element) + "', which is not applied");
}

RawMesh Placement::mesh(const std::string& node) {
  const std::string path = main_model_of(archive_);
  if (path.empty())
    refuse("no 3D model is in it; it is damaged, or another zip archive", name_, kSaveAgain);
  settings_ = slicer_settings(archive_, name_);
  key_store_ = file::in_lower_case(archive_.unpacked("Secure/keystore.xml").value_or(""));
  main_ = &part(path);
  for (std::size_t k = 0; k < main_->build.size(); ++k) {
    const ThreemfItem& item = main_->build[k];
    const auto word = settings_.parts.find({item.object, item.object});
    if (!item.is_printed || settings_.unprinted.contains(k))
      ++unprinted_;
    else
      place(*main_, item, 0, {}, word != settings_.parts.end() ? word->second : item.setting);
  }
  const NodeChoice choice(nodes_, name_);
  const std::vector<std::size_t> chosen = choice.choose(node);
  RawMesh mesh;
  mesh.name = name_;
  mesh.format = MeshFormat::threemf;
  mesh.metres_per_unit = main_->metres;
  add_notes(mesh);
  if (chosen.empty()) {
    refuse("its build places no mesh that is solid" +
               (mesh.notes.empty() ? "" : "; " + mesh.notes.front()),
           name_, kExport);
  }
  for (const std::size_t k : chosen) add(k, mesh);
  char metres[32];
  std::snprintf(metres, sizeof metres, "%.6g m", main_->metres);
  mesh.notes.insert(mesh.notes.begin(),
                    std::string("its unit is taken to be ") + metres +
                        (main_->unit.empty() ? ", which 3MF has by default"
                                             : ", the " + main_->unit + " that the file names") +
                        "; transforms of nodes were applied; z is up, as in the file");
  if (chosen.size() > 1) mesh.notes.push_back(choice.joined(chosen));
  return mesh;
}

}  // namespace

RawMesh parse_threemf(std::string_view bytes, const std::string& name, const std::string& node) {
  try {
    return Placement(bytes, name).mesh(node);
  } catch (const std::bad_alloc&) {
    refuse("it unpacks to more than " +
               std::to_string(file::most_memory(bytes.size()) / 1'000'000) +
               " MB, or to more vertices than are read; it is damaged",
           name, kSaveAgain);
  }
}

}  // namespace vpm
