#include "libvpm/file/sniff.h"

#include <algorithm>
#include <cctype>
#include <cstring>
#include <string_view>
#include <vector>

#include "libvpm/file/container_layout.h"
#include "libvpm/file/ply_header.h"
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
constexpr const char* kExtractPng = "extract its depth images as 16-bit PNG, for example by ffmpeg";
constexpr const char* kSaveNpy = "save its array as .npy";
constexpr const char* kSaveArray = "save one of its arrays as 16-bit PNG";
constexpr const char* kExportPly = "export it as PLY";
constexpr const char* kToPack = "give it to vpm-pack";

constexpr Start kStarts[] = {
    {"\x89vpm"sv, "a file of vpm (.vpmp, .vpmg, .vpmc)", "give the file that was meant"},
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
    {"\x80\x02"sv, "a pickle of Python", kSaveNpy, Holds::scan},
    {"\x80\x03"sv, "a pickle of Python", kSaveNpy, Holds::scan},
    {"\x80\x04\x95"sv, "a pickle of Python", kSaveNpy, Holds::scan},
    {"\x80\x05\x95"sv, "a pickle of Python", kSaveNpy, Holds::scan},
    {"(dp0"sv, "a pickle of Python", kSaveNpy, Holds::scan},
    {"(lp0"sv, "a pickle of Python", kSaveNpy, Holds::scan},
    {"par1"sv, "a table in Parquet", "save it as CSV"},
    {"arrow1\0\0"sv, "a table of Arrow", "save it as CSV"},
    {"%pdf"sv, "a PDF document", "give the file that was meant"},
    {"\x89hdf"sv, "an HDF5 file", "save one of its arrays as .npy or 16-bit PNG", Holds::scan},
    {"matlab 5.0"sv, "a MATLAB file", kSaveArray, Holds::scan},
    {"matlab 7.3"sv, "a MATLAB file (HDF5)", kSaveArray, Holds::scan},
    {"\x1a\x65\xdf\xa3"sv, "a Matroska recording (.mkv), such as an Azure Kinect's", kExtractPng,
     Holds::scan},
    {"#rosbag"sv, "a ROS bag",
     "convert it to MCAP: rosbags-convert --src BAG --dst OUT --dst-storage mcap", Holds::scan},
    {"\x89mcap"sv, "an MCAP recording", "give its file to vpm-normals, or to vpm-query --frames",
     Holds::scan},
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
     "convert the bag's folder to MCAP: rosbags-convert --src FOLDER --dst OUT --dst-storage mcap",
     Holds::scan},
    {"pieh"sv, "a depth map of Sintel (.dpt) or optical flow (.flo)", kSaveDepths, Holds::scan},
    {"\xff\xfe\0\0"sv, "text in UTF-32", "save it as UTF-8"},
    {"\xff\xfe"sv, "text in UTF-16", "save it as UTF-8"},
    {"\xfe\xff"sv, "text in UTF-16", "save it as UTF-8"},
    {"gltf\2\0\0\0"sv, "a scene in glTF", kToPack, Holds::mesh},
    {"kaydara fbx binary"sv, "a scene in FBX", kToPack, Holds::mesh},
    {"solid "sv, "a mesh in STL", kToPack, Holds::mesh},
    {"off\n"sv, "a mesh in OFF", kToPack, Holds::mesh},
    {"off\r\n"sv, "a mesh in OFF", kToPack, Holds::mesh},
};

// Depth images and clouds, whose letters have one case.
struct ScanStart {
  std::string_view bytes;
  ScanFormat format;
};

constexpr ScanStart kScanStarts[] = {
    {"\x89PNG"sv, ScanFormat::png},   {"\x76\x2f\x31\x01"sv, ScanFormat::exr},
    {"II*\0"sv, ScanFormat::tiff},    {"MM\0*"sv, ScanFormat::tiff},
    {"II+\0"sv, ScanFormat::tiff},    {"MM\0+"sv, ScanFormat::tiff},
    {"\x93NUMPY"sv, ScanFormat::npy}, {"# .PCD"sv, ScanFormat::pcd},
    {"VERSION "sv, ScanFormat::pcd},  {"FIELDS "sv, ScanFormat::pcd},
};

// Words for each of ScanFormat, in its order.
constexpr const char* kScanWords[] = {"a PNG picture",     "an OpenEXR image",
                                      "a TIFF image",      "a PGM, PPM or PFM image",
                                      "an array of NumPy", "a cloud of points (PCD)",
                                      "a PLY file",        "a message of ROS' compressedDepth"};

// Elements that a file begins with, or has behind the declaration of XML.
constexpr Start kElements[] = {
    {"<x3d"sv, "a scene in X3D", kExport, Holds::mesh},
    {"<amf"sv, "a mesh in AMF", kExport, Holds::mesh},
    {"<collada"sv, "a scene in COLLADA", kToPack, Holds::mesh},
    {"<vtkfile"sv, "a file of VTK", kExportPly},
};

Content content_of(const Start& known) {
  return {known.what, known.next, known.holds, {}, known.next == kToPack};
}

// Tells the kinds of XML by what stands behind the declaration and comments.
std::optional<Content> xml_kind(std::span<const std::byte> bytes) {
  constexpr std::size_t kLooked = 4096;
  const std::string text = in_lower_case(as_text(bytes.first(std::min(bytes.size(), kLooked))));
  const std::size_t begin = std::min(text.find_first_not_of(" \t\r\n"), text.size());
  if (text.compare(begin, 5, "<?xml") != 0) return std::nullopt;
  for (const char* const robot : {"<robot", "<mujoco", "<sdf"}) {
    if (text.find(robot) != text.npos)
      return Content{"a robot description (URDF, MJCF, SDF)", "give one of the files that it names",
                     Holds::mesh};
  }
  for (const Start& element : kElements)
    if (text.find(element.bytes) != text.npos) return content_of(element);
  return Content{"an XML file", "give the file that was meant"};
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

// True if zeros stand before or behind each of the first characters, all printable or ends of
// lines.
bool is_wide_text_without_mark(std::string_view text) {
  constexpr std::size_t kLooked = 6;
  if (text.size() < kLooked) return false;
  const auto are_zero = [&](std::size_t first) {
    for (std::size_t k = 0; k < kLooked; ++k) {
      const bool is_text =
          (text[k] >= ' ' && text[k] <= '~') || (text[k] >= '\t' && text[k] <= '\r');
      if (k % 2 == first ? text[k] != '\0' : !is_text) return false;
    }
    return true;
  };
  return are_zero(0) || are_zero(1);
}

// True for the header of an array of numbers as MATLAB 4 wrote it: its type, rows, columns, whether
// it is complex and the length of its name, which ends in 0.
bool is_matlab_4(std::string_view bytes) {
  constexpr std::size_t kHeader = 20, kLongestName = 64;
  constexpr std::uint32_t kLargestType = 52;
  if (bytes.size() < kHeader) return false;
  const auto word = [&](std::size_t k) { return unsigned_at(bytes, 4 * k); };
  const std::uint64_t name = word(4);
  if (word(0) > kLargestType || word(1) == 0 || word(2) == 0 || word(3) > 1 || name < 2 ||
      name > kLongestName || bytes.size() < kHeader + name)
    return false;
  const std::string_view letters = bytes.substr(kHeader, name);
  return letters.find('\0') == name - 1 &&
         std::ranges::all_of(letters.substr(0, name - 1), [](char c) {
           return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
         });
}

// True for the payload of a message of ROS' compressedDepth that is coded by RVL: 12 bytes, of
// which all are 0 for depths in integers, columns, rows, and fewer bytes than an image has.
bool is_rvl_of_ros(std::string_view bytes) {
  constexpr std::size_t kHeader = 12, kSizes = 8;
  constexpr std::uint64_t kFewest = 16, kMost = 16384;  // columns or rows
  if (bytes.size() <= kHeader + kSizes) return false;
  if (bytes.substr(0, kHeader).find_first_not_of('\0') != bytes.npos) return false;
  const std::uint64_t columns = unsigned_at(bytes, kHeader), rows = unsigned_at(bytes, kHeader + 4);
  return columns >= kFewest && columns <= kMost && rows >= kFewest && rows <= kMost &&
         bytes.size() - kHeader - kSizes < 2 * columns * rows;
}

// Tells formats that begin with no word of their own.
std::optional<Content> kind_by_layout(std::string_view text) {
  constexpr std::size_t kCardMark = 72;  // IGES has cards of 80 columns
  const auto is_card = [&](std::size_t at) {
    return text.size() > at + kCardMark + 8 && text[at + kCardMark] == 'S' &&
           text.substr(at + kCardMark + 1, 7).find_first_not_of(" 0123456789") == text.npos;
  };
  if (is_card(0)) return Content{"a file of CAD in IGES", kExportMesh, Holds::mesh};
  if (text.size() >= 6 && text.starts_with("MM")) {  // a chunk that is the whole file
    if (unsigned_at(text, 2) == text.size())
      return Content{"a scene of 3D Studio (3DS)", kExport, Holds::mesh};
  }
  if (is_wide_text_without_mark(text))
    return Content{"text in UTF-16 without its mark", "save it as UTF-8"};
  if (text.size() > 8 && text.substr(4, 4) == "ftyp")
    return Content{"a video (MP4, MOV) or a HEIC picture", kExtractPng, Holds::scan};
  constexpr std::size_t kMarkOfTar = 257;
  if (text.size() > kMarkOfTar && text.substr(kMarkOfTar).starts_with("ustar"))
    return Content{"an archive (tar)", "unpack it first: tar xf"};
  if (is_rvl_of_ros(text)) {
    return Content{"a message of ROS' compressedDepth, coded by RVL",
                   "decode it by compressed_depth_image_transport, and save it as 16-bit PNG",
                   Holds::scan};
  }
  if (is_matlab_4(text)) return Content{"a MATLAB file", kSaveArray, Holds::scan};
  if (is_mesh_of_mujoco(text)) return Content{"a mesh of MuJoCo (.msh)", kExport, Holds::mesh};
  if (is_map_of_colmap(text.substr(0, 64)))
    return Content{"a depth map of COLMAP", kSaveDepths, Holds::scan};
  TextCursor cursor(text.substr(0, 4096));
  std::vector<std::string_view> first = cursor.row();
  while (first.size() == 1 && first[0] == "999") {  // a comment, in the line after
    cursor.line();
    first = cursor.row();
  }
  if (first.size() == 1 && first[0] == "0" && cursor.word() == "SECTION")
    return Content{"a drawing in DXF", kExportMesh, Holds::mesh};
  return std::nullopt;
}

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

std::optional<ScanFormat> scan_format(std::string_view text) {
  constexpr std::size_t kBeforePng = 12;  // bytes that ROS' compressedDepth puts before its PNG
  if (looks_like_ply(text)) return ScanFormat::ply;
  for (const ScanStart& start : kScanStarts)
    if (text.starts_with(start.bytes)) return start.format;
  if (is_netpbm(text)) return ScanFormat::netpbm;
  if (is_commented_pcd(text)) return ScanFormat::pcd;
  const bool is_message =
      text.size() > kBeforePng && text.substr(kBeforePng).starts_with("\x89PNG");
  return is_message ? std::optional(ScanFormat::compressed_depth) : std::nullopt;
}

std::optional<Content> own_kind(std::span<const std::byte> bytes) {
  Preamble preamble;
  if (bytes.size() < sizeof preamble) return std::nullopt;
  std::memcpy(&preamble, bytes.data(), sizeof preamble);
  if (std::memcmp(preamble.magic, kMagic, sizeof kMagic) != 0) return std::nullopt;
  const Kind kind = static_cast<Kind>(preamble.kind);
  const char* const next = kind == Kind::packing      ? "it is ready for vpm-graph"
                           : kind == Kind::tool_model ? "it is ready for vpm-query"
                           : kind == Kind::cloud      ? "it is ready for vpm-query"
                                                      : "give the file that was meant";
  return Content{names_of(kind).what, next};
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

std::optional<Content> sniff(std::span<const std::byte> bytes) {
  constexpr std::size_t kMostBlanks = 64, kLongestStart = 32;
  if (const auto scan = scan_format(without_byte_order_mark(as_text(bytes))))
    return Content{kScanWords[static_cast<std::size_t>(*scan)], "give it to vpm-normals",
                   Holds::scan, scan, false};
  if (auto own = own_kind(bytes)) return own;
  const std::string_view text =
      as_text(bytes.first(std::min(bytes.size(), kMostBlanks + kLongestStart)));
  const std::size_t begin = std::min(text.find_first_not_of(" \t\r\n"), text.size());
  const std::string start = in_lower_case(text.substr(begin));
  for (const Start& known : kStarts)
    if (start.starts_with(known.bytes)) return content_of(known);
  for (const Start& element : kElements)
    if (start.starts_with(element.bytes)) return content_of(element);
  if (auto xml = xml_kind(bytes)) return xml;
  return kind_by_layout(as_text(bytes));
}

}  // namespace vpm::file
