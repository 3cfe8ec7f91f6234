#include "libvpm/import/file_format.h"

#include <string_view>

#include "libvpm/core/error.h"
#include "libvpm/file/foreign_content.h"
#include "libvpm/file/text.h"

namespace vpm {
namespace {

using std::string_view_literals::operator""sv;

struct Start {
  std::string_view bytes;
  FileFormat format;
};

constexpr Start kStarts[] = {
    {"\x89PNG\r\n\x1a\n"sv, FileFormat::png},
    {"\x76\x2f\x31\x01"sv, FileFormat::exr},
    {"II*\0"sv, FileFormat::tiff},
    {"MM\0*"sv, FileFormat::tiff},
    {"II+\0"sv, FileFormat::tiff},
    {"MM\0+"sv, FileFormat::tiff},
    {"\x93NUMPY"sv, FileFormat::npy},
    {"ply\n"sv, FileFormat::ply},
    {"ply\r"sv, FileFormat::ply},
    {"# .PCD"sv, FileFormat::pcd},
    {"VERSION"sv, FileFormat::pcd},
    {"FIELDS"sv, FileFormat::pcd},
    {"#"sv, FileFormat::pcd},
};

bool is_netpbm(std::string_view text) {
  return text.size() > 2 && text[0] == 'P' && "23456fF"sv.find(text[1]) != std::string_view::npos &&
         " \t\r\n#"sv.find(text[2]) != std::string_view::npos;
}

}  // namespace

FileFormat format_of(std::span<const std::byte> bytes, const std::string& name) {
  const std::string_view text = file::as_text(bytes);
  if (text.empty()) refuse("the file is empty", name, "give a depth image or a cloud");
  if (const auto other = file::foreign_content(bytes))
    refuse("this is " + other->what, name,
           other->holds == file::Holds::mesh
               ? "give a depth image or a cloud, or the mesh to vpm-pack"
               : other->next);
  for (const Start& start : kStarts)
    if (text.starts_with(start.bytes)) return start.format;
  if (is_netpbm(text)) return FileFormat::netpbm;
  refuse("neither PNG, OpenEXR, TIFF, PGM, PFM, NPY, PCD nor PLY by its content", name,
         "give a depth image or a cloud");
}

}  // namespace vpm
