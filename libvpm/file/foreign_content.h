// Recognises files that are neither mesh, depth image nor cloud by their first bytes.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>

namespace vpm::file {

struct ForeignContent {
  std::string what;  // "a Git LFS pointer, not the file itself"
  std::string next;  // advice that helps, such as the command to give
};

// Returns what the file is, if it is one of those that people give by mistake: Git LFS pointers,
// web pages, archives, pictures, recordings, CAD and robot descriptions, files of this library of
// any kind.
std::optional<ForeignContent> foreign_content(std::span<const std::byte> bytes);

}  // namespace vpm::file
