// Opens the handles of the public headers to the library itself: makes them, and returns what they
// hold. Programs cannot do either.
#pragma once

#include <vpm/scene.h>
#include <vpm/solid.h>
#include <vpm/tool.h>

#include <memory>
#include <utility>
#include <vector>

#include "libvpm/core/handle.h"

namespace vpm {

struct HandleAccess {
  // Makes the handle of something that the library has made and checked.
  template <class Handle, class Held>
  static Handle make(Held held) {
    return Handle(std::make_shared<const Held>(std::move(held)));
  }

  static const Cloud& held(const PointCloud& cloud) { return held_by(cloud.cloud_, "PointCloud"); }
  // Returns the solid that a body is, or null.
  static const PlacedSolid* solid_of(const Body& body) { return body.solid_.get(); }
  // Returns a body that is no solid.
  static const AnyBody& held(const Body& body) { return held_by(body.body_, "Body"); }
  static const std::vector<AnyBody>& held(const Scene& scene) {
    return held_by(scene.list_, "Scene");
  }
  static const std::vector<PlacedSolid>& solids(const Scene& scene) {
    return held_by(scene.solids_, "Scene");
  }
  static const ToolModel& held(const Tool& tool) { return held_by(tool.model_, "Tool"); }
  static const std::shared_ptr<const ToolModel>& shared(const Tool& tool) { return tool.model_; }
  static const CheckedSolid& held(const SolidMesh& mesh) {
    return held_by(mesh.solid_, "SolidMesh");
  }
  // Returns the surface that a body shares, and the model, which is null for a mesh.
  static const std::shared_ptr<const SolidSurface>& shared(const SolidBody& body) {
    held_by(body.surface_, "SolidBody");
    return body.surface_;
  }
  static const std::shared_ptr<const ToolModel>& model(const SolidBody& body) {
    return body.model_;
  }
  static const Packing& held(const SpherePacking& packing) {
    return held_by(packing.packing_, "SpherePacking");
  }
};

}  // namespace vpm
