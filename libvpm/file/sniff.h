// Recognises files by their first bytes: one table for all readers, so that what one of them names,
// all name.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace vpm::file {

// Kind of input that a file leads to.
enum class Holds { anything, mesh, scan };

// Formats of depth images and clouds that are read here; the last is the payload of a message of
// ROS' compressedDepth, of which 12 bytes stand before a PNG.
enum class ScanFormat { png, exr, tiff, netpbm, npy, pcd, ply, compressed_depth };

struct Content {
  std::string what;  // "a Git LFS pointer, not the file itself"
  std::string next;  // advice that helps, for a program that takes what the file holds
  Holds holds = Holds::anything;
  std::optional<ScanFormat> scan = {};  // set if it is one; a PLY may hold a mesh, too
  bool is_mesh = false;                 // in a format that vpm-pack reads
};

// Returns what the file is, if its bytes tell: depth images and clouds, meshes, and what people
// give by mistake, such as Git LFS pointers, web pages, archives, pictures, recordings, CAD, robot
// descriptions, text in UTF-16, and files of this library of any kind. OBJ and other texts of
// numbers tell nothing by their first bytes.
std::optional<Content> sniff(std::span<const std::byte> bytes);

// True if the first lines are three numbers or more each, as many in each, after a heading or count
// perhaps: files of points (XYZ, PTS, CSV), or images as text. OFF files may begin with three
// counts, too, without their keyword; these have lines of other lengths.
bool is_table_of_numbers(std::string_view text);

}  // namespace vpm::file
