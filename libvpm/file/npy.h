// Reads arrays of NumPy (numpy.org/doc/stable/reference/generated/numpy.lib.format.html).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "libvpm/file/scalar_type.h"

namespace vpm::file {

// Array of numbers in a file in memory, which must outlive it.
struct NpyArray {
  ScalarType type;  // float of 16, 32 or 64 bits, or integer
  bool big_endian = false, by_columns = false;
  std::vector<std::uint64_t> shape;
  std::uint64_t size = 0;             // numbers: the product of the shape
  std::span<const std::byte> values;  // at least that many

  // Returns the k-th number, counted row by row: the last index runs fastest.
  double at(std::uint64_t k) const;
};

// Reads the header of an .npy file. Throws Error(refused), naming `name` and the defect, for
// values that are no such numbers, and for files that are truncated.
NpyArray parse_npy(std::span<const std::byte> bytes, const std::string& name);

// Returns a shape in words: "2 x 4 x 4".
std::string shape_text(const std::vector<std::uint64_t>& shape);

}  // namespace vpm::file
