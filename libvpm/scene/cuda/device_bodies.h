// Holds bodies in the memory of a device: their surfaces as kernels take them, plain pointers and
// numbers.
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <utility>
#include <vector>

#include "libvpm/device/cuda/device_array.h"
#include "libvpm/scene/any_body.h"

namespace vpm::cuda {

// Points to the device memory for an image, by pixel.
struct ImageRoom {
  Vec3f* normals = nullptr;   // camera axes, as DepthSurface reads them
  float* measured = nullptr;  // inverse depth, 1/m, holes closed; -0 where a pixel was removed
  InverseDepthRange* tiles[DepthSurface::kMaxLevels] = {};
  std::int32_t levels = 0;
};

class DeviceDepthBody {
 public:
  explicit DeviceDepthBody(const PreparedImage& image) : DeviceDepthBody(image.surface()) {}
  explicit DeviceDepthBody(const DepthSurface& surface);
  // Allocates memory for an image, which kernels fill (cloud_prepare.h).
  explicit DeviceDepthBody(const Camera& camera);

  const ImageRoom& room() const { return room_; }
  const DepthSurface& surface() const { return surface_; }

 private:
  // Takes the arrays of an image; `tiles` holds all levels, one after another.
  void set(const DepthSurface& image, const ImageRoom& room, InverseDepthRange* tiles);

  DeviceMemory memory_;
  ImageRoom room_;
  DepthSurface surface_;
};

// Holds what a device has made of an image in the host's memory.
class FetchedImage {
 public:
  explicit FetchedImage(const DeviceDepthBody& image);

  // Begins to copy the image from the device to the host, in a stream; it is there when the stream
  // is done.
  void fetch(cudaStream_t stream);
  const DepthSurface& surface() const { return surface_; }

 private:
  const DepthSurface image_;  // on the device
  MappedArray<Vec3f> normals_;
  MappedArray<float> measured_;
  MappedArray<InverseDepthRange> tiles_;  // all levels, one after another
  DepthSurface surface_;
};

class DevicePointsBody {
 public:
  explicit DevicePointsBody(const PreparedPoints& points);
  const DiskSurface& surface() const { return surface_; }

 private:
  DeviceMemory memory_;
  DiskSurface surface_;
};

// Holds the images of several cameras. Copies those that were not made on this device.
class DeviceRigBody {
 public:
  explicit DeviceRigBody(const PreparedRig& rig);
  const RigSurface& surface() const { return surface_; }

 private:
  std::vector<DepthBody> made_here_;
  std::vector<DeviceDepthBody> copies_;
  DeviceArray<std::byte> room_, copied_;  // what kernels fill, and what the host gives
  RigSurface surface_;
};

// Returns the copy of a body on the current device, shared by all queries that hold it.
template <class Kind>
std::shared_ptr<const typename Kind::OnDevice> on_device(const Kind& body) {
  using Copy = typename Kind::OnDevice;
  static std::mutex mutex;
  static std::map<std::pair<int, std::uint64_t>, std::weak_ptr<const Copy>> copies;
  const auto& prepared = body.prepared();
  const std::lock_guard lock(mutex);
  std::erase_if(copies, [](const auto& entry) { return entry.second.expired(); });
  std::weak_ptr<const Copy>& known = copies[{current_device(), prepared.serial()}];
  std::shared_ptr<const Copy> copy = known.lock();
  if (!copy) known = copy = std::make_shared<const Copy>(prepared);
  return copy;
}

// Holds the copies of a scene's bodies on a device.
class BodyCopies {
 public:
  // Returns the copy of a body, on the current device.
  template <class Kind>
  const typename Kind::OnDevice& of(const Kind& body) {
    auto& copies = std::get<Copies<Kind>>(copies_);
    const std::uint64_t serial = body.prepared().serial();
    const auto known = std::ranges::find(copies, serial, &Copies<Kind>::value_type::first);
    if (known != copies.end()) return *known->second;
    return *copies.emplace_back(serial, on_device(body)).second;
  }
  // Gives back copies of bodies that are not in the scene.
  void keep_only(std::span<const AnyBody> scene) {
    const auto is_needed = [&](const auto& copy) {
      return std::ranges::any_of(scene,
                                 [&](const AnyBody& body) { return body.serial() == copy.first; });
    };
    std::apply([&](auto&... each) { (std::erase_if(each, std::not_fn(is_needed)), ...); }, copies_);
  }

 private:
  template <class Kind>
  using Copies =
      std::vector<std::pair<std::uint64_t, std::shared_ptr<const typename Kind::OnDevice>>>;
  BodyKinds::Tuple<Copies> copies_;
};

}  // namespace vpm::cuda
