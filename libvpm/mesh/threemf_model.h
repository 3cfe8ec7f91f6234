// The model parts of 3MF files, as the core specification and its production extension describe
// them: objects, which are meshes or are composed of others, and the build, which places them.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "libvpm/core/pose.h"
#include "libvpm/model/solid.h"

namespace vpm {

// Triangles `first` to `last` of a mesh, which a slicer gives a role in a word of its own.
struct ThreemfVolume {
  std::uint64_t first, last;
  std::string role;
};

struct ThreemfComponent {
  std::string path;  // names the model part that has the object; empty for the component's own
  std::uint64_t object = 0;
  Pose place;  // to the coordinates around it; its rotation may be any matrix
};

// Object that the build places.
struct ThreemfItem : ThreemfComponent {
  std::string setting;  // as that of an object
  bool is_printed = true;
};

struct ThreemfObject {
  std::string name;
  std::string role;     // "model", "support", ... by the core specification
  std::string setting;  // Cura's word for it, if it is no part of the solid; of components, too
  std::vector<Vec3> vertices;
  std::vector<Triangle> triangles;
  std::vector<ThreemfVolume> volumes;  // where Slic3r tells the roles of triangles
  std::vector<ThreemfComponent> components;
  std::string unread;   // names what its shape depends on beside meshes and components
  std::string ignored;  // names what else it has beside them
};

struct ThreemfModel {
  std::string unit;      // as the file names it; empty where it does not
  double metres = .001;  // length of the unit
  std::map<std::uint64_t, ThreemfObject> objects;
  std::vector<ThreemfItem> build;
};

// Reads a model part, given its XML, in the file's unit. Throws Error(refused) with the file's name
// for damaged XML, numbers that are none or are not finite, indices out of range, an unknown unit,
// and required extensions that may change shapes and are not known here.
ThreemfModel threemf_model(std::string_view xml, const std::string& name);

}  // namespace vpm
