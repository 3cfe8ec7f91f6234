#include <zlib.h>

#include <vector>

#include "libvpm/import/depth_files.h"
#include "libvpm/import/import_cloud.h"
#include "tests/fuzz/query_check.h"
#include "tests/fuzz/targets.h"

namespace vpm::fuzz {
namespace {

constexpr std::size_t kMostBytes = 64 * 1024;  // largest cloud that is queried

void run_cloud(Bytes input, const std::string& name, bool has_intrinsics) {
  if (input.size() > kMostBytes) return;
  expect_error_at_most([&] {
    ImportOptions options;
    if (has_intrinsics) options.intrinsics = {20, 20, 7.5, 5.5};
    const ImportedCloud imported = import_cloud(input, name, options);
    validate(imported.cloud, "imported");
    expect_sound_answers(imported.cloud, Choice(input));
  });
}

constexpr std::size_t kMostQueriedPixels = 1024;  // largest image that is queried

// Reads the image alone, whatever its size, and imports it if it is small.
template <class Parser>
void run_depth(Bytes input, const std::string& name, const Parser& parse) {
  expect_error_at_most([&] {
    const RawDepth raw = parse();
    if (raw.values.size() != std::size_t{raw.width} * raw.height)
      fail("an image has not the size that it says");
    if (raw.values.size() > kMostQueriedPixels) return;
    ImportOptions options;
    options.intrinsics = {20, 20, 7.5, 5.5};
    expect_sound_answers(import_cloud(input, name, options).cloud, Choice(input));
  });
}

// Mends the checksums of PNG's chunks, without which nothing after them would be reached.
std::vector<std::byte> with_mended_chunks(Bytes input) {
  std::vector<std::byte> bytes(input.begin(), input.end());
  constexpr std::size_t kSignature = 8, kAround = 12;  // length, type and checksum of a chunk
  for (std::size_t at = kSignature; at + kAround <= bytes.size();) {
    std::size_t size = 0;
    for (std::size_t k = 0; k < 4; ++k) size = size << 8 | static_cast<std::size_t>(bytes[at + k]);
    if (size > bytes.size() - at - kAround) break;
    const auto* data = reinterpret_cast<const Bytef*>(bytes.data() + at + 4);
    const uLong sum = crc32(0, data, static_cast<uInt>(size + 4));
    for (std::size_t k = 0; k < 4; ++k)
      bytes[at + 8 + size + k] = static_cast<std::byte>(sum >> (24 - 8 * k) & 0xff);
    at += kAround + size;
  }
  return bytes;
}

}  // namespace

// The length decides whether there are intrinsics, so that seeds are plain files.
void run_pcd(Bytes input) {
  run_cloud(input, "x.pcd", input.size() % 2 == 1);
}
void run_ply_points(Bytes input) {
  run_cloud(input, "x.ply", false);
}

void run_png(Bytes input) {
  const std::vector<std::byte> mended = with_mended_chunks(input);
  run_depth(mended, "x.png", [&] { return parse_png_depth(mended, "x.png"); });
}
void run_exr(Bytes input) {
  run_depth(input, "x.exr", [&] { return parse_exr_depth(input, "x.exr", ""); });
}
void run_tiff(Bytes input) {
  run_depth(input, "x.tif", [&] { return parse_tiff_depth(input, "x.tif"); });
}
void run_netpbm(Bytes input) {
  run_depth(input, "x.pgm", [&] { return parse_netpbm_depth(input, "x.pgm"); });
}
void run_npy(Bytes input) {
  run_depth(input, "x.npy", [&] { return parse_npy_depth(input, "x.npy"); });
}

}  // namespace vpm::fuzz
