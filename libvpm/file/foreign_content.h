// Recognises files that are neither mesh, depth image nor cloud by their first bytes.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>

namespace vpm::file {

// Kind of input that a file leads to.
enum class Holds { anything, mesh, scan };

struct ForeignContent {
  std::string what;  // "a Git LFS pointer, not the file itself"
  std::string next;  // advice that helps, for a program that takes what the file holds
  Holds holds = Holds::anything;
};

// Returns what the file is, if it is one of those that people give by mistake: Git LFS pointers,
// web pages, archives, pictures, recordings, CAD and robot descriptions, meshes and scenes of
// formats that are not read here, text in UTF-16, files of this library of any kind.
std::optional<ForeignContent> foreign_content(std::span<const std::byte> bytes);

}  // namespace vpm::file
