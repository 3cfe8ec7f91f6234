// Recognises files that are neither mesh, depth image nor cloud by their first bytes.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>

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

// True if the first lines are three numbers or more each, as many in each, after a heading or count
// perhaps: files of points (XYZ, PTS, CSV), or images as text. OFF files may begin with three
// counts, too, without their keyword; these have lines of other lengths.
bool is_table_of_numbers(std::string_view text);

}  // namespace vpm::file
