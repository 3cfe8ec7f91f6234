// Depth images as arrays of NumPy.
#include <string>
#include <vector>

#include "libvpm/core/error.h"
#include "libvpm/file/npy.h"
#include "libvpm/import/depth_files.h"

namespace vpm {
namespace {

[[noreturn]] void fail(const std::string& defect, const std::string& name,
                       const std::string& hint = {}) {
  refuse("not a depth image in NPY: " + defect, name, hint);
}

// Refuses a table with a point in each row: as an image it would be a few pixels wide.
void refuse_table(const std::vector<std::uint64_t>& shape, const std::string& name) {
  constexpr std::uint64_t kMostColumns = 8, kRowsPerColumn = 16;
  if (shape[1] < 3 || shape[1] > kMostColumns || shape[0] < kRowsPerColumn * shape[1]) return;
  fail("its " + std::to_string(shape[0]) + " rows of " + std::to_string(shape[1]) +
           " numbers are a table of points",
       name, "save them as PLY or PCD, with their normals");
}

// Returns rows and columns of a shape, of which other dimensions are 1.
std::vector<std::uint64_t> rows_and_columns(std::vector<std::uint64_t> shape,
                                            const std::string& name) {
  for (std::size_t k = 0; shape.size() > 2 && k < shape.size();)
    shape[k] == 1 ? void(shape.erase(shape.begin() + static_cast<std::ptrdiff_t>(k))) : void(++k);
  if (shape.size() == 2) return shape;
  const bool ends_in_xyz = shape.size() == 3 && shape.back() <= 4;
  fail("an array of " + file::shape_text(shape) + "; depth has two dimensions, rows and columns",
       name, ends_in_xyz ? "save only the z of the point at each pixel" : "");
}

}  // namespace

RawDepth parse_npy_depth(std::span<const std::byte> bytes, const std::string& name) {
  const file::NpyArray array = file::parse_npy(bytes, name);
  if (array.type.size == 1)
    fail("integers of 8 bits; depth is a float or an integer of 16 bits or more", name);
  const std::vector<std::uint64_t> shape = rows_and_columns(array.shape, name);
  if (array.type.kind == 'F') refuse_table(shape, name);
  check_image_size(shape[1], shape[0], name);
  RawDepth image;
  image.height = static_cast<std::uint32_t>(shape[0]);
  image.width = static_cast<std::uint32_t>(shape[1]);
  image.are_integers = array.type.kind != 'F';
  image.are_16_bit = array.type.kind == 'U' && array.type.size == 2;
  image.values.resize(array.size);
  for (std::uint64_t k = 0; k < array.size; ++k) image.values[k] = static_cast<float>(array.at(k));
  return image;
}

}  // namespace vpm
