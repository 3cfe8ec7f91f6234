// PNG, NPY, PGM, PFM and TIFF.
#include <gtest/gtest.h>
#ifdef VPM_TESTS_TIFF
#include <tiffio.h>
#endif

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "libvpm/file/stream.h"
#include "libvpm/file/temporary_folder.h"
#include "libvpm/import/depth_files.h"
#include "tests/import/test_files.h"
#include "tests/refusal.h"

namespace vpm {
namespace {

const std::vector<std::uint16_t> kPngValues{0, 1, 255, 256, 1000, 65535};

std::string png_refusal(const std::string& file) {
  return test::refusal([&] { parse_png_depth(bytes_of(file), "file"); });
}

TEST(PngDepth, GivesTheValues) {
  for (const bool interlaced : {false, true}) {
    const std::string file = make_png(3, 2, 16, kPngValues, interlaced);
    const RawDepth image = parse_png_depth(bytes_of(file), "file");
    EXPECT_EQ(image.width, 3U);
    EXPECT_EQ(image.height, 2U);
    EXPECT_EQ(image.values, (std::vector<float>{0, 1, 255, 256, 1000, 65535}));
    EXPECT_EQ(image.usual_units_per_metre(), 1000);
  }
}

TEST(PngDepth, RefusesOtherImages) {
  EXPECT_TRUE(says(png_refusal(make_png(3, 2, 8, kPngValues)), "16 bits"));
  EXPECT_TRUE(says(png_refusal("\x89PNG\r\n\x1a\n and then nothing"), "file: not a sound PNG"));
}

TEST(PngDepth, RefusesSizesThatTheFileCannotHold) {
  std::string file = make_png(3, 2, 16, kPngValues);
  file.replace(16, 8, std::string("\x00\x00\x20\x00\x00\x00\x20\x00", 8));  // 8192 x 8192
  // Refuses without taking memory; libpng notices the wrong checksum of the header.
  EXPECT_NE(png_refusal(file), "");
  const std::vector<std::uint16_t> row(100000);
  EXPECT_EQ(png_refusal(make_png(100000, 1, 16, row)), "");
}

TEST(PngDepth, DamageIsRefused) {
  expect_damage_is_refused(make_png(3, 2, 16, kPngValues), 1000,
                           [](auto bytes) { parse_png_depth(bytes, "file"); });
}

const std::vector<float> kRows{1, 2, 3, 4, 5, 6};

template <class Value>
Value in_other_order(Value value) {
  std::string bytes;
  append(bytes, value);
  std::string turned(bytes.rbegin(), bytes.rend());
  std::memcpy(&value, turned.data(), sizeof value);
  return value;
}

// Returns an array whose header says what is given and whose values follow.
template <class Value>
std::string make_npy(const std::string& type, const std::string& order, const std::string& shape,
                     const std::vector<Value>& values) {
  const std::string header =
      "{'descr': '" + type + "', 'fortran_order': " + order + ", 'shape': " + shape + ", }\n";
  std::string file("\x93NUMPY\x01\x00", 8);
  append(file, static_cast<std::uint16_t>(header.size()));
  file += header;
  for (const Value value : values) append(file, value);
  return file;
}

RawDepth npy(const std::string& file) {
  return parse_npy_depth(bytes_of(file), "file");
}

TEST(NpyDepth, ReadsTypesAndOrders) {
  const RawDepth floats = npy(make_npy<float>("<f4", "False", "(2, 3)", kRows));
  EXPECT_EQ(floats.width, 3U);
  EXPECT_EQ(floats.values, kRows);
  EXPECT_FALSE(floats.are_integers);
  EXPECT_EQ(npy(make_npy<double>("<f8", "False", "(1, 2, 3)", {1, 2, 3, 4, 5, 6})).values, kRows);
  EXPECT_EQ(npy(make_npy<float>("<f4", "True", "(2, 3, 1)", {1, 4, 2, 5, 3, 6})).values, kRows);
  std::vector<std::uint16_t> big;
  for (std::uint16_t k = 1; k <= 6; ++k) big.push_back(in_other_order(k));
  const RawDepth integers = npy(make_npy<std::uint16_t>(">u2", "False", "(2, 3)", big));
  EXPECT_EQ(integers.values, kRows);
  EXPECT_TRUE(integers.are_16_bit);
  const std::vector<std::uint16_t> halves{0x3C00, 0x4000, 0x4200, 0x4400, 0x4500, 0x4600};
  EXPECT_EQ(npy(make_npy<std::uint16_t>("<f2", "False", "(2, 3)", halves)).values, kRows);
}

TEST(NpyDepth, RefusesWhatIsNoDepth) {
  const auto refused = [](const std::string& file) { return test::refusal([&] { npy(file); }); };
  const std::vector<float> many(6000);
  EXPECT_TRUE(
      says(refused(make_npy<char>("|u1", "False", "(2, 3)", {1, 2, 3, 4, 5, 6})), "8 bits"));
  const std::string points = refused(make_npy<float>("<f4", "False", "(2, 3, 3)", many));
  EXPECT_TRUE(says(points, "an array of 2 x 3 x 3; depth has two dimensions"));
  EXPECT_TRUE(says(points, "save only the z"));
  for (const char* const shape : {"(64, 3)", "(64, 4)", "(1000, 6)", "(1, 64, 3)"})
    EXPECT_TRUE(says(refused(make_npy<float>("<f4", "False", shape, many)),
                     "are a table of points; save them as PLY or PCD, with their normals"))
        << shape;
  for (const char* const shape : {"(64, 2)", "(64, 9)", "(47, 3)", "(3, 64)"})
    EXPECT_TRUE(says(refused(make_npy<float>("<f4", "False", shape, kRows)), "truncated")) << shape;
  EXPECT_TRUE(says(refused(make_npy<float>("<i4", "False", "(64, 3)", kRows)), "truncated"));
  EXPECT_TRUE(says(refused(make_npy<float>("<f4", "False", "(20, 3)", kRows)), "truncated"));
  expect_damage_is_refused(make_npy<float>("<f4", "False", "(2, 3)", kRows), 300,
                           [](auto bytes) { parse_npy_depth(bytes, "file"); });
}

RawDepth netpbm(const std::string& file) {
  return parse_netpbm_depth(bytes_of(file), "file");
}

TEST(NetpbmDepth, ReadsPgmAndPfm) {
  std::string pgm = "P5\n# by hand\n3 2\n65535\n";
  for (std::uint16_t k = 1; k <= 6; ++k) append(pgm, in_other_order(k));
  EXPECT_EQ(netpbm(pgm).values, kRows);
  EXPECT_TRUE(netpbm(pgm).are_16_bit);
  EXPECT_EQ(netpbm("P2 3 2 4095 1 2 3\n4 5 6\n").values, kRows);
  EXPECT_EQ(netpbm("P2 3 2 4095 1 2 3 # 9\n# row 2\n4 5 6\n#").values, kRows);
  std::string pfm = "Pf\n3 2\n-1.0\n";
  for (const float value : {4.F, 5.F, 6.F, 1.F, 2.F, 3.F}) append(pfm, value);
  EXPECT_EQ(netpbm(pfm).values, kRows);
  EXPECT_FALSE(netpbm(pfm).are_integers);
}

TEST(NetpbmDepth, SaysWhatFollowsTheFirstImage) {
  std::string pgm = "P5 3 2 65535\n";
  for (std::uint16_t k = 1; k <= 6; ++k) append(pgm, in_other_order(k));
  EXPECT_TRUE(netpbm(pgm + "\n").remarks.empty());
  for (const std::string& two : {pgm + pgm, std::string("P2 1 1 4095 7\nP2 1 1 4095 8\n")}) {
    const Remarks remarks = netpbm(two).remarks;
    ASSERT_EQ(remarks.size(), 1U);
    EXPECT_TRUE(says(remarks[0].text, "several images"));
  }
  EXPECT_TRUE(says(netpbm(pgm + "more").remarks.at(0).text, "4 bytes"));
}

TEST(NetpbmDepth, RefusesWhatIsNoDepth) {
  const auto refused = [](const std::string& file) { return test::refusal([&] { netpbm(file); }); };
  EXPECT_TRUE(says(refused("P5 3 2 255\n123456"), "16 bits"));
  EXPECT_TRUE(says(refused("P6 3 2 65535\n"), "colour"));
  EXPECT_TRUE(says(refused("P5 3 2 65535\n12345"), "truncated"));
  EXPECT_TRUE(says(refused("Pf 3 2 0\n"), "scale is 0"));
}

#ifdef VPM_TESTS_TIFF
// Writes the rows with libtiff.
template <class Value>
std::string make_tiff(int format, bool tiled, const std::vector<Value>& values, const char* mode) {
  const file::TemporaryFolder folder;
  const std::string path = folder.path("a.tif");
  TIFF* file = TIFFOpen(path.c_str(), mode);
  TIFFSetField(file, TIFFTAG_IMAGEWIDTH, 3);
  TIFFSetField(file, TIFFTAG_IMAGELENGTH, 2);
  TIFFSetField(file, TIFFTAG_BITSPERSAMPLE, static_cast<int>(8 * sizeof(Value)));
  TIFFSetField(file, TIFFTAG_SAMPLESPERPIXEL, 1);
  TIFFSetField(file, TIFFTAG_SAMPLEFORMAT, format);
  TIFFSetField(file, TIFFTAG_COMPRESSION, COMPRESSION_LZW);
  TIFFSetField(file, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
  TIFFSetField(file, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
  std::vector<Value> buffer(256);
  if (tiled) {
    TIFFSetField(file, TIFFTAG_TILEWIDTH, 16);
    TIFFSetField(file, TIFFTAG_TILELENGTH, 16);
    for (std::size_t k = 0; k < values.size(); ++k) buffer[k / 3 * 16 + k % 3] = values[k];
    TIFFWriteTile(file, buffer.data(), 0, 0, 0, 0);
  } else {
    for (std::uint32_t v = 0; v < 2; ++v) {
      std::copy_n(values.begin() + 3 * v, 3, buffer.begin());
      TIFFWriteScanline(file, buffer.data(), v, 0);
    }
  }
  TIFFClose(file);
  const std::vector<std::byte> bytes = file::read_all(path);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

TEST(TiffDepth, ReadsRowsAndTilesOfBothByteOrders) {
  for (const char* mode : {"wl", "wb"}) {
    for (const bool tiled : {false, true}) {
      const RawDepth floats = parse_tiff_depth(
          bytes_of(make_tiff<float>(SAMPLEFORMAT_IEEEFP, tiled, kRows, mode)), "file");
      EXPECT_EQ(floats.values, kRows);
      EXPECT_FALSE(floats.are_integers);
      const RawDepth integers = parse_tiff_depth(
          bytes_of(make_tiff<std::uint16_t>(SAMPLEFORMAT_UINT, tiled, {1, 2, 3, 4, 5, 6}, mode)),
          "file");
      EXPECT_EQ(integers.values, kRows);
      EXPECT_TRUE(integers.are_16_bit);
    }
  }
}

TEST(TiffDepth, RefusesWhatIsNoDepth) {
  const std::string bytes =
      make_tiff<std::uint8_t>(SAMPLEFORMAT_UINT, false, {1, 2, 3, 4, 5, 6}, "w");
  EXPECT_TRUE(says(test::refusal([&] { parse_tiff_depth(bytes_of(bytes), "file"); }), "8 bits"));
  // The last bytes, the offset of the next image, may be missing.
  const std::string whole = make_tiff<float>(SAMPLEFORMAT_IEEEFP, false, kRows, "w");
  for (std::size_t size = 0; size + 4 < whole.size(); ++size) {
    EXPECT_NE(test::refusal([&] { parse_tiff_depth(bytes_of(whole.substr(0, size)), "file"); }), "")
        << size;
  }
  for (std::size_t at = 0; at < whole.size(); ++at) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(~damaged[at]);
    test::refusal([&] { parse_tiff_depth(bytes_of(damaged), "file"); });
  }
}
#endif

// Returns the payload of a message of ROS' compressedDepth: format, two floats, PNG.
std::string compressed_depth(float a, float b, const std::string& png) {
  std::string bytes;
  append(bytes, std::int32_t{0});
  append(bytes, a);
  append(bytes, b);
  return bytes + png;
}

TEST(CompressedDepth, MillimetresAreReadAndCodedFloatsRefused) {
  const std::string png = make_png(3, 2, 16, {1000, 1001, 0, 1003, 65000, 1005});
  const RawDepth plain = parse_png_depth(bytes_of(png), "file");
  // The configuration of images of millimetres is left as it was in memory.
  for (const auto& [a, b] : {std::pair{0.F, 0.F}, {1e-38F, 3e10F}, {10100.F, 0.F}, {-5.F, 5.F}}) {
    const std::string file = compressed_depth(a, b, png);
    EXPECT_EQ(parse_compressed_depth(bytes_of(file), "file").values, plain.values) << a;
  }
  // Depths of quantisation 100 up to 10 m, as ROS codes them without being told otherwise.
  const std::string coded = compressed_depth(10100, 1 - 10100 / 10.F, png);
  const std::string fault = test::refusal([&] { parse_compressed_depth(bytes_of(coded), "file"); });
  EXPECT_TRUE(says(fault, "compressedDepth of float depths"));
  EXPECT_TRUE(says(fault, "inverse depths"));
}

}  // namespace
}  // namespace vpm
