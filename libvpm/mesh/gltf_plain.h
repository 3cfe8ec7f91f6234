// glTF files in the form that assimp reads: numbers as floats, and each instance as a node.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

namespace vpm {

// Returns the file as GLB in one piece, if it has what assimp does not read: positions or weights
// of integers (KHR_mesh_quantization) or instances (EXT_mesh_gpu_instancing); nothing otherwise.
// Such a file keeps only what places its faces. `content` is the JSON, and `chunk` the binary data
// of a GLB. Throws Error(refused) with the file's name for numbers that are not in the file, or
// too many for one of its size.
std::optional<std::string> as_plain_gltf(const nlohmann::json& content, std::string_view chunk,
                                         const std::string& name, std::uint64_t most_bytes);

}  // namespace vpm
