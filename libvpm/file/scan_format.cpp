#include "libvpm/file/scan_format.h"

#include <string_view>
#include <vector>

#include "libvpm/file/ply_header.h"
#include "libvpm/file/text.h"

namespace vpm::file {
namespace {

using std::string_view_literals::operator""sv;

struct Start {
  std::string_view bytes;
  ScanFormat format;
};

constexpr Start kStarts[] = {
    {"\x89PNG"sv, ScanFormat::png},   {"\x76\x2f\x31\x01"sv, ScanFormat::exr},
    {"II*\0"sv, ScanFormat::tiff},    {"MM\0*"sv, ScanFormat::tiff},
    {"II+\0"sv, ScanFormat::tiff},    {"MM\0+"sv, ScanFormat::tiff},
    {"\x93NUMPY"sv, ScanFormat::npy}, {"# .PCD"sv, ScanFormat::pcd},
    {"VERSION"sv, ScanFormat::pcd},   {"FIELDS"sv, ScanFormat::pcd},
};

// True if comments come first, as in "# .PCD v0.7" in other words, and then an entry of a PCD's
// header: other texts begin with comments too.
bool is_commented_pcd(std::string_view text) {
  if (!text.starts_with('#')) return false;
  TextCursor cursor(text);
  while (const auto line = cursor.line()) {
    const std::vector<std::string_view> words = split_words(*line);
    if (words.empty() || words[0].starts_with('#')) continue;
    return words[0] == "VERSION" || words[0] == "FIELDS" || words[0] == "COLUMNS";
  }
  return false;
}

bool is_netpbm(std::string_view text) {
  return text.size() > 2 && text[0] == 'P' && "23456fF"sv.find(text[1]) != std::string_view::npos &&
         " \t\r\n#"sv.find(text[2]) != std::string_view::npos;
}

}  // namespace

std::optional<ScanFormat> scan_format(std::span<const std::byte> bytes) {
  const std::string_view text = without_byte_order_mark(as_text(bytes));
  if (looks_like_ply(text)) return ScanFormat::ply;
  for (const Start& start : kStarts)
    if (text.starts_with(start.bytes)) return start.format;
  if (is_netpbm(text)) return ScanFormat::netpbm;
  if (is_commented_pcd(text)) return ScanFormat::pcd;
  return std::nullopt;
}

const char* describe(ScanFormat format) {
  switch (format) {
    case ScanFormat::png:
      return "a PNG picture";
    case ScanFormat::exr:
      return "an OpenEXR image";
    case ScanFormat::tiff:
      return "a TIFF image";
    case ScanFormat::netpbm:
      return "a PGM, PPM or PFM image";
    case ScanFormat::npy:
      return "an array of NumPy";
    case ScanFormat::pcd:
      return "a cloud of points (PCD)";
    case ScanFormat::ply:
      return "a PLY file";
  }
  return "";
}

}  // namespace vpm::file
