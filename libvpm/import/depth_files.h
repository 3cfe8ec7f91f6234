// Reads depth images of other programs.
//
// All functions throw Error(refused), naming `name` and the defect, for damaged files and those
// that are no depth image.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "libvpm/file/stream.h"
#include "libvpm/import/remark.h"

namespace vpm {

// Depth image as a file stores it; depth_values.h makes metres of it.
struct RawDepth {
  std::uint32_t width = 0, height = 0;
  std::vector<float> values;    // row by row from the top; integers as they are
  bool are_integers = false;    // usually millimetres; floats are usually metres
  bool are_16_bit = false;      // integers of 16 bits, which may be coded (DepthDecoding)
  bool may_be_swapped = false;  // writers of this format disagree about the order of bytes
  Remarks remarks;
  Remarks unit_remarks;  // about the unit, which are left out where the user tells it

  double usual_units_per_metre() const { return are_integers ? 1000 : 1; }
};

// Reads a 16-bit gray PNG.
RawDepth parse_png_depth(std::span<const std::byte> bytes, const std::string& name);

// Reads the payload of a message of ROS' compressedDepth, a PNG of millimetres behind 12 bytes. Of
// floats, the PNG holds coded inverse depths instead, which are refused.
RawDepth parse_compressed_depth(std::span<const std::byte> bytes, const std::string& name);

// Reads the depth channel of an OpenEXR file (exr_channels.h tells which); HALF, FLOAT or UINT.
// Pixels of the display window that are not stored become 0. Throws Error(unavailable) in builds
// without OpenEXR.
RawDepth parse_exr_depth(std::span<const std::byte> bytes, const std::string& name,
                         const std::string& channel);

// Reads the first image of a TIFF file: one channel of 16-bit integers, 32-bit integers or floats.
// Throws Error(unavailable) in builds without libtiff.
RawDepth parse_tiff_depth(std::span<const std::byte> bytes, const std::string& name);

// Reads PGM of more than 8 bits, in text (P2) or binary (P5), and gray PFM (Pf).
RawDepth parse_netpbm_depth(std::span<const std::byte> bytes, const std::string& name);

// Reads an array of NumPy (.npy) of two dimensions, or three of which one is 1.
RawDepth parse_npy_depth(std::span<const std::byte> bytes, const std::string& name);

// Throws Error(refused) for sizes of 0 and more than kMaxPoints pixels.
void check_image_size(std::uint64_t width, std::uint64_t height, const std::string& name);

// Throws Error(refused) if the floats of a compressed image would take more memory than a file of
// this many bytes may ask for (file::most_memory).
void check_image_memory(std::uint64_t width, std::uint64_t height, std::uint64_t file_bytes,
                        const std::string& name);

// Returns the shortest text that reads back as the number, or as the float if it is one.
std::string number_text(double value);

// Remark about a file that goes on after its first image.
inline constexpr const char* kSeveralImages = "it holds several images; the first is read";

}  // namespace vpm
