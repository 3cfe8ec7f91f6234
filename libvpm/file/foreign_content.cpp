#include "libvpm/file/foreign_content.h"

#include <algorithm>
#include <cstring>
#include <string_view>
#include <vector>

#include "libvpm/file/container_layout.h"
#include "libvpm/file/scalar_type.h"
#include "libvpm/file/text.h"

namespace vpm::file {
namespace {

using std::string_view_literals::operator""sv;

struct Start {
  std::string_view bytes;  // in lower case if they are letters
  const char* what;
  const char* next;
  Holds holds = Holds::anything;
};

constexpr const char* kExport = "export it as OBJ, PLY or STL";
constexpr const char* kExportMesh = "export a mesh from it, as OBJ, PLY or STL";

constexpr const char* kSaveDepths = "save its depths as .npy, PFM or 16-bit PNG";
constexpr const char* kExportPly = "export it as PLY";

constexpr Start kStarts[] = {
    {"version https://git-lfs"sv, "a Git LFS pointer, not the file itself",
     "fetch it with: git lfs pull"},
    {"<!doctype html"sv, "a web page", "download the file itself"},
    {"<html"sv, "a web page", "download the file itself"},
    {"<mujoco"sv, "a robot description (MJCF)", "give one of the files that it names", Holds::mesh},
    {"<robot"sv, "a robot description (URDF)", "give one of the files that it names", Holds::mesh},
    {"\x1f\x8b"sv, "compressed by gzip", "unpack it first: gunzip"},
    {"pk\x03\x04"sv, "an archive (zip, npz)", "unpack it first; of an npz, save one array as .npy"},
    {"bzh"sv, "compressed by bzip2", "unpack it first: bunzip2"},
    {"\xfd\x37zxz"sv, "compressed by xz", "unpack it first: unxz"},
    {"\xff\xd8\xff"sv, "a JPEG picture, which holds no exact values",
     "give the 16-bit or float image", Holds::scan},
    {"gif8"sv, "a GIF picture", "give the 16-bit or float image", Holds::scan},
    {"riff"sv, "a WebP picture or a film", "give the 16-bit or float image", Holds::scan},
    {"#?r"sv, "a Radiance picture", "give the 16-bit or float image", Holds::scan},
    {"p7\n"sv, "a PAM picture", "save it as PGM, or as 16-bit PNG", Holds::scan},
    {"\x80\x04\x95"sv, "a pickle of Python", "save its array as .npy", Holds::scan},
    {"%pdf"sv, "a PDF document", "give the file that was meant"},
    {"\x89hdf"sv, "an HDF5 file", "save one of its arrays as .npy or 16-bit PNG", Holds::scan},
    {"matlab 5.0"sv, "a MATLAB file", "save one of its arrays as 16-bit PNG", Holds::scan},
    {"#rosbag"sv, "a ROS bag", "extract its images or clouds first", Holds::scan},
    {"\x89mcap"sv, "an MCAP recording", "extract its images or clouds first", Holds::scan},
    {"lasf"sv, "a LAS cloud", "convert it to PLY with normals, for example by PDAL", Holds::scan},
    {"astm-e57"sv, "an E57 cloud", "convert it to PLY with normals, for example by PDAL",
     Holds::scan},
    {"iso-10303-21"sv, "a STEP file of CAD", kExportMesh, Holds::mesh},
    {"blender"sv, "a Blender file", kExportMesh, Holds::mesh},
    {"7z\xbc\xaf"sv, "compressed by 7-Zip", "unpack it first: 7z x"},
    {"\x28\xb5\x2f\xfd"sv, "compressed by zstd", "unpack it first: unzstd"},
    {"\x04\x22\x6d\x18"sv, "compressed by LZ4", "unpack it first: unlz4"},
    {"\xd0\xcf\x11\xe0"sv, "a file of SolidWorks or of an office program", kExportMesh,
     Holds::mesh},
    {"#usda"sv, "a scene in USD", kExport, Holds::mesh},
    {"pxr-usdc"sv, "a scene in USD", kExport, Holds::mesh},
    {"#vrml"sv, "a scene in VRML", kExport, Holds::mesh},
    {"#x3d"sv, "a scene in X3D", kExport, Holds::mesh},
    {"# vtk datafile"sv, "a file of VTK", kExportPly},
    {"draco"sv, "compressed by Draco", "decode it to PLY: draco_decoder"},
    {"$meshformat"sv, "a mesh of Gmsh", kExport, Holds::mesh},
    {"meshversionformatted"sv, "a mesh of MEDIT", kExport, Holds::mesh},
    {"3d geometry file format"sv, "a file of Rhino", kExportMesh, Holds::mesh},
    {"xof 0"sv, "a mesh of DirectX", kExport, Holds::mesh},
    {"**abcdefgh"sv, "a file of CAD in Parasolid", kExportMesh, Holds::mesh},
    {"autocad binary dxf"sv, "a drawing in DXF", kExportMesh, Holds::mesh},
    {"ac10"sv, "a drawing in DWG", kExportMesh, Holds::mesh},
    {"octm"sv, "a mesh of OpenCTM", kExport, Holds::mesh},
    {"dbrep_drawableshape"sv, "a file of CAD in BREP", kExportMesh, Holds::mesh},
    {"cascade topology"sv, "a file of CAD in BREP", kExportMesh, Holds::mesh},
    {"*heading"sv, "a model of Abaqus", kExportMesh, Holds::mesh},
    {"*node"sv, "a model of Abaqus", kExportMesh, Holds::mesh},
    {"sqlite format 3"sv, "a database of SQLite, such as a bag of ROS 2",
     "extract its images or clouds first", Holds::scan},
    {"pieh"sv, "a depth map of Sintel (.dpt) or optical flow (.flo)", kSaveDepths, Holds::scan},
    {"\xff\xfe"sv, "text in UTF-16", "save it as UTF-8"},
    {"\xfe\xff"sv, "text in UTF-16", "save it as UTF-8"},
};

// Elements that a file begins with, or has behind the declaration of XML.
constexpr Start kElements[] = {
    {"<x3d"sv, "a scene in X3D", kExport, Holds::mesh},
    {"<amf"sv, "a mesh in AMF", kExport, Holds::mesh},
    {"<vtkfile"sv, "a file of VTK", kExportPly},
};

ForeignContent content_of(const Start& known) {
  return {known.what, known.next, known.holds};
}

// Tells the kinds of XML by what stands behind the declaration and comments.
std::optional<ForeignContent> xml_kind(std::span<const std::byte> bytes) {
  constexpr std::size_t kLooked = 4096;
  const std::string text = in_lower_case(as_text(bytes.first(std::min(bytes.size(), kLooked))));
  const std::size_t begin = std::min(text.find_first_not_of(" \t\r\n"), text.size());
  if (text.compare(begin, 5, "<?xml") != 0) return std::nullopt;
  for (const char* const robot : {"<robot", "<mujoco", "<sdf"}) {
    if (text.find(robot) != text.npos)
      return ForeignContent{"a robot description (URDF, MJCF, SDF)",
                            "give one of the files that it names", Holds::mesh};
  }
  for (const Start& element : kElements)
    if (text.find(element.bytes) != text.npos) return content_of(element);
  return ForeignContent{"an XML file", "give the file that was meant"};
}

// True for counts of vertices, normals, texture coordinates and faces that tell the file's size.
bool is_mesh_of_mujoco(std::string_view bytes) {
  constexpr std::size_t kCounts = 16, kTriple = 12, kPair = 8;
  if (bytes.size() < kCounts + 4 * kTriple) return false;
  const std::uint64_t vertices = unsigned_at(bytes, 0), normals = unsigned_at(bytes, 4),
                      pairs = unsigned_at(bytes, 8), faces = unsigned_at(bytes, 12);
  return vertices > 2 &&
         kTriple * (vertices + normals + faces) + kPair * pairs == bytes.size() - kCounts;
}

// True for "160&120&1&", width, height and channels, before the values.
bool is_map_of_colmap(std::string_view bytes) {
  std::size_t at = 0;
  for (int k = 0; k < 3; ++k) {
    const std::size_t end = std::min(bytes.find_first_not_of("0123456789", at), bytes.size());
    if (end == at || end == bytes.size() || bytes[end] != '&') return false;
    at = end + 1;
  }
  return true;
}

// Tells formats that begin with no word of their own.
std::optional<ForeignContent> kind_by_layout(std::string_view text) {
  constexpr std::size_t kCardMark = 72;  // IGES has cards of 80 columns
  const auto is_card = [&](std::size_t at) {
    return text.size() > at + kCardMark + 8 && text[at + kCardMark] == 'S' &&
           text.substr(at + kCardMark + 1, 7).find_first_not_of(" 0123456789") == text.npos;
  };
  if (is_card(0)) return ForeignContent{"a file of CAD in IGES", kExportMesh, Holds::mesh};
  if (text.size() >= 6 && text.starts_with("MM")) {  // a chunk that is the whole file
    if (unsigned_at(text, 2) == text.size())
      return ForeignContent{"a scene of 3D Studio (3DS)", kExport, Holds::mesh};
  }
  if (is_mesh_of_mujoco(text))
    return ForeignContent{"a mesh of MuJoCo (.msh)", kExport, Holds::mesh};
  if (is_map_of_colmap(text.substr(0, 64)))
    return ForeignContent{"a depth map of COLMAP", kSaveDepths, Holds::scan};
  TextCursor cursor(text.substr(0, 4096));
  std::vector<std::string_view> first = cursor.row();
  while (first.size() == 1 && first[0] == "999") {  // a comment, in the line after
    cursor.line();
    first = cursor.row();
  }
  if (first.size() == 1 && first[0] == "0" && cursor.word() == "SECTION")
    return ForeignContent{"a drawing in DXF", kExportMesh, Holds::mesh};
  return std::nullopt;
}

std::optional<ForeignContent> own_kind(std::span<const std::byte> bytes) {
  Preamble preamble;
  if (bytes.size() < sizeof preamble) return std::nullopt;
  std::memcpy(&preamble, bytes.data(), sizeof preamble);
  if (std::memcmp(preamble.magic, kMagic, sizeof kMagic) != 0) return std::nullopt;
  const Kind kind = static_cast<Kind>(preamble.kind);
  const char* const next = kind == Kind::packing      ? "it is ready for vpm-graph"
                           : kind == Kind::tool_model ? "it is ready for vpm-query"
                           : kind == Kind::cloud      ? "it is ready for vpm-query"
                                                      : "give the file that was meant";
  return ForeignContent{names_of(kind).what, next};
}

bool is_number(std::string_view word) {
  return to_number(word).has_value();
}

// True for a comment, names of columns, or a count of points.
bool is_heading(std::string_view line, const std::vector<std::string_view>& cells) {
  if (line.starts_with('#') || line.starts_with("//")) return true;
  if (cells.size() == 1) return to_count(cells[0]).has_value();
  return cells.size() >= 3 && std::none_of(cells.begin(), cells.end(), is_number);
}

}  // namespace

bool is_table_of_numbers(std::string_view text) {
  constexpr int kLooked = 4;                     // lines
  constexpr std::size_t kMostBytes = 1U << 16U;  // a line of a wide image
  TextCursor cursor(text.substr(0, kMostBytes));
  std::size_t columns = 0;
  int rows = 0;
  for (int k = 0; k < kLooked; ++k) {
    const std::optional<std::string_view> line = cursor.line();
    const bool is_cut = cursor.remaining() == 0 && text.size() > kMostBytes;
    if (!line || is_cut) break;
    const std::vector<std::string_view> cells = split_words(*line, " \t,;");
    if (k == 0 && is_heading(*line, cells)) continue;
    if (k > 0 && cells.empty()) break;
    if (cells.size() < 3 || !std::all_of(cells.begin(), cells.end(), is_number)) return false;
    if (rows > 0 && cells.size() != columns) return false;
    columns = cells.size();
    ++rows;
  }
  return rows > 1;
}

std::optional<ForeignContent> foreign_content(std::span<const std::byte> bytes) {
  constexpr std::size_t kMostBlanks = 64, kLongestStart = 32;
  const std::string_view text =
      as_text(bytes.first(std::min(bytes.size(), kMostBlanks + kLongestStart)));
  const std::size_t begin = std::min(text.find_first_not_of(" \t\r\n"), text.size());
  const std::string start = in_lower_case(text.substr(begin));
  for (const Start& known : kStarts)
    if (start.starts_with(known.bytes)) return content_of(known);
  for (const Start& element : kElements)
    if (start.starts_with(element.bytes)) return content_of(element);
  if (auto xml = xml_kind(bytes)) return xml;
  if (auto other = kind_by_layout(as_text(bytes))) return other;
  return own_kind(bytes);
}

}  // namespace vpm::file
