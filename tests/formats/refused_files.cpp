#include "tests/formats/refused_files.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <stdexcept>

#include "libvpm/file/checksum.h"
#include "libvpm/file/container_layout.h"

namespace vpm::golden {
namespace {

using file::ChunkEntry;
using file::Kind;
using file::Preamble;

// The bytes of a container, to be damaged field by field. bytes() renews the checksums.
class Spoiled {
 public:
  explicit Spoiled(std::vector<std::byte> bytes) : bytes_(std::move(bytes)) { load(); }

  Preamble preamble{};
  std::vector<ChunkEntry> table;

  ChunkEntry& entry(const char* id, std::uint32_t index) {
    for (ChunkEntry& e : table) {
      if (std::memcmp(e.id, id, 4) == 0 && e.index == index) return e;
    }
    throw std::logic_error(std::string("no chunk ") + id);
  }

  template <class T>
  Spoiled& set(const char* chunk, std::uint32_t index, std::size_t at, T value) {
    std::memcpy(bytes_.data() + entry(chunk, index).offset + at, &value, sizeof(value));
    return *this;
  }

  Spoiled& replace_in_header(const std::string& from, const std::string& to) {
    char* header = reinterpret_cast<char*>(bytes_.data()) + sizeof(Preamble) +
                   table.size() * sizeof(ChunkEntry);
    const std::size_t at = std::string(header, preamble.header_size).find(from);
    if (at == std::string::npos || from.size() != to.size()) throw std::logic_error(from);
    std::memcpy(header + at, to.data(), to.size());
    return *this;
  }

  Spoiled& set_header(std::string header) {
    if (header.size() > preamble.header_size) throw std::logic_error(header);
    header.resize(preamble.header_size, ' ');
    std::memcpy(bytes_.data() + sizeof(Preamble) + table.size() * sizeof(ChunkEntry), header.data(),
                header.size());
    return *this;
  }

  std::vector<std::byte> bytes() {
    for (ChunkEntry& e : table) {
      if (e.offset <= bytes_.size() && e.size <= bytes_.size() - e.offset)
        e.checksum = file::checksum(std::span(bytes_).subspan(e.offset, e.size));
    }
    return with_directory_checksums();
  }

  std::vector<std::byte> with_directory_checksums() {
    std::memcpy(bytes_.data() + sizeof(Preamble), table.data(), table.size() * sizeof(ChunkEntry));
    const std::size_t directory = table.size() * sizeof(ChunkEntry) + preamble.header_size;
    if (directory <= bytes_.size() - sizeof(Preamble)) {
      preamble.directory_checksum =
          file::checksum(std::span(bytes_).subspan(sizeof(Preamble), directory));
    }
    return with_preamble_checksum();
  }

  std::vector<std::byte> with_preamble_checksum() {
    preamble.preamble_checksum = file::checksum(
        std::as_bytes(std::span(&preamble, 1)).first(offsetof(Preamble, preamble_checksum)));
    std::memcpy(bytes_.data(), &preamble, sizeof(preamble));
    return bytes_;
  }

 private:
  void load() {
    std::memcpy(&preamble, bytes_.data(), sizeof(preamble));
    const std::size_t room = (bytes_.size() - sizeof(Preamble)) / sizeof(ChunkEntry);
    table.resize(std::min<std::size_t>(preamble.chunk_count, room));
    std::memcpy(table.data(), bytes_.data() + sizeof(Preamble), table.size() * sizeof(ChunkEntry));
  }

  std::vector<std::byte> bytes_;
};

std::vector<std::byte> with_byte(std::vector<std::byte> bytes, std::size_t at, unsigned value) {
  bytes.at(at) = static_cast<std::byte>(value);
  return bytes;
}

// Sets one member of the preamble or of a table entry.
template <class Change>
std::vector<std::byte> with_preamble(const std::vector<std::byte>& bytes, Change change) {
  Spoiled spoiled(bytes);
  change(spoiled.preamble);
  return spoiled.with_preamble_checksum();
}
template <class Change>
std::vector<std::byte> with_entry(const std::vector<std::byte>& bytes, Change change) {
  Spoiled spoiled(bytes);
  change(spoiled.entry("VERT", 0));
  return spoiled.bytes();
}

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::uint32_t kMost = std::numeric_limits<std::uint32_t>::max();

void add_containers(std::vector<RefusedFile>& all, const std::vector<std::byte>& good) {
  const auto add = [&](const char* name, const char* message, std::vector<std::byte> bytes) {
    all.push_back({std::string(name) + ".vpmp", Kind::packing, message, std::move(bytes)});
  };
  add("empty", "the file is empty", {});
  add("not_vpm", "not a vpm file", with_byte(good, 0, 'P'));
  add("line_ends_changed", "transfer as text", with_byte(good, 4, '\n'));
  add("short_preamble", "cut short", {good.begin(), good.begin() + 40});
  add("newer_version", "layout version 2",
      with_preamble(good, [](Preamble& p) { p.layout_version = 2; }));
  add("unknown_required_flag", "features 0x00000100",
      with_preamble(good, [](Preamble& p) { p.required_flags = 0x100; }));
  add("unknown_kind", "kind that this build does not know",
      with_preamble(good, [](Preamble& p) { p.kind = 77; }));
  add("reserved_field", "reserved field", with_preamble(good, [](Preamble& p) { p.reserved = 1; }));
  add("size_overflow", "cut short",
      with_preamble(good, [](Preamble& p) { p.file_size = ~std::uint64_t{0}; }));
  add("many_chunks", "more than the file holds",
      with_preamble(good, [](Preamble& p) { p.chunk_count = kMost; }));
  add("large_header", "more than the file holds",
      with_preamble(good, [](Preamble& p) { p.header_size = kMost; }));
  std::vector<std::byte> longer = good;
  longer.push_back(std::byte{0});
  add("bytes_too_many", "bytes too many", longer);
  add("bytes_after_chunks", "follow the last chunk", [&] {
    Spoiled spoiled(longer);
    spoiled.preamble.file_size += 1;
    return spoiled.bytes();
  }());

  add("checksum_preamble", "first 64 bytes are damaged", with_byte(good, 40, 1));
  add("checksum_table", "chunk table or the header is damaged", with_byte(good, 70, 1));
  add("checksum_chunk", "chunk TRIA 0 is damaged", with_byte(good, good.size() - 1, 255));

  add("chunk_offset_overflow", "VERT 0 lies outside",
      with_entry(good, [](ChunkEntry& e) { e.offset = ~std::uint64_t{0} - 63; }));
  add("chunk_size_overflow", "VERT 0 lies outside",
      with_entry(good, [](ChunkEntry& e) { e.size = ~std::uint64_t{0} / 24 * 24; }));
  add("chunk_overlap", "VERT 0 lies outside",
      with_entry(good, [](ChunkEntry& e) { e.offset -= 64; }));
  add("chunk_no_elements", "makes no sense",
      with_entry(good, [](ChunkEntry& e) { e.element_size = 0; }));
  add("chunk_part_element", "makes no sense", with_entry(good, [](ChunkEntry& e) { e.size -= 1; }));
  add("chunk_other_element", "elements of 8 bytes instead of 24",
      with_entry(good, [](ChunkEntry& e) { e.element_size = 8; }));
  add("chunk_missing", "chunk VERT 0 is missing",
      with_entry(good, [](ChunkEntry& e) { e.id[0] = 'X'; }));
  add("chunk_twice", "chunk SPHR 0 is there twice",
      with_entry(good, [](ChunkEntry& e) { std::memcpy(e.id, "SPHR", 4); }));
  add("header_not_json", "not a JSON object", Spoiled(good).replace_in_header("{", "<").bytes());
  add("header_too_deep", "nested too deeply",
      Spoiled(good)
          .set_header("{\"unit\":\"m\",\"x\":" + std::string(33, '[') + std::string(33, ']') + "}")
          .bytes());
  add("header_other_unit", "unit is not \"m\"",
      Spoiled(good).replace_in_header("\"unit\":\"m\"", "\"unit\":\"k\"").bytes());
}

void add_packings(std::vector<RefusedFile>& all, const std::vector<std::byte>& good) {
  const auto add = [&](const char* name, const char* message, Spoiled& spoiled) {
    all.push_back({std::string(name) + ".vpmp", Kind::packing, message, spoiled.bytes()});
  };
  add("sphere_not_finite", "sphere 1 is not finite", Spoiled(good).set("SPHR", 0, 32, kNan));
  add("sphere_radius_negative", "sphere 7 has a radius", Spoiled(good).set("SPHR", 0, 248, -1.0));
  add("sphere_ascending", "sphere 2 is larger", Spoiled(good).set("SPHR", 0, 88, 0.06));
  add("vertex_infinite", "vertex 3 of the solid is not finite",
      Spoiled(good).set("VERT", 0, 80, kInfinity));
  add("triangle_out_of_range", "triangle 1 of the solid names vertex 8",
      Spoiled(good).set("TRIA", 0, 12, std::uint32_t{8}));
}

void add_models(std::vector<RefusedFile>& all, const std::vector<std::byte>& good) {
  const auto add = [&](const char* name, const char* message, Spoiled& spoiled) {
    all.push_back({std::string(name) + ".vpmg", Kind::tool_model, message, spoiled.bytes()});
  };
  using u32 = std::uint32_t;
  add("volume_negative", "volume", Spoiled(good).set("TOOL", 0, 0, -1.0));
  add("sphere_beyond_reach", "sphere 0 or its cell lies beyond",
      Spoiled(good).set("TOOL", 0, 32, 0.1));
  add("level_too_large", "levels must ascend", Spoiled(good).set("LEVL", 0, 124, u32{9}));
  add("level_not_ascending", "levels must ascend", Spoiled(good).set("LEVL", 0, 124, u32{4}));
  add("edge_out_of_range", "neighbours of row 0", Spoiled(good).set("EDGN", 1, 8, kMost));
  add("edge_one_way", "no way back", Spoiled(good).set("EDGN", 1, 8, u32{7}));
  add("edge_rows_descend", "row offsets of neighbours", Spoiled(good).set("EDGB", 1, 4, kMost));
  add("node_own_child", "children out of range", Spoiled(good).set("NODE", 1, 32, u32{0}));
  add("node_shared_child", "shares a child", Spoiled(good).set("NODE", 1, 2 * 48 + 32, u32{3}));
  add("node_many_leaves", "children out of range", Spoiled(good).set("NODE", 1, 48 + 36, kMost));
  add("node_not_reached", "cannot be reached", Spoiled(good).set("NODE", 1, 36, u32{2}));
  add("node_unknown_flag", "unknown flags", Spoiled(good).set("NODE", 1, 44, u32{1}));
  add("leaf_twice", "each once", Spoiled(good).set("LEAF", 1, 0, u32{1}));
  add("grid_overflow", "exceeds 2^32 - 1", Spoiled(good).set("LEVL", 0, 64 + 40, kMost));
  add("grid_too_large", "row offsets instead of", Spoiled(good).set("LEVL", 0, 64 + 40, u32{3}));
  add("grid_cell_zero", "positive cell size", Spoiled(good).set("LEVL", 0, 32, 0.0));
  add("cell_not_finite", "cell 2 is negative or not finite",
      Spoiled(good).set("SHRV", 0, 16, kNan));
  add("block_out_of_range", "block 3 has samples",
      Spoiled(good).set("BLCK", 0, 3 * 24 + 20, kMost));
  add("sample_weight_infinite", "sample 0 is negative or not finite",
      Spoiled(good).set("SMPL", 0, 16, kInfinity));
}

void add_calibrations(std::vector<RefusedFile>& all, const std::vector<std::byte>& good) {
  const auto add = [&](const char* name, const char* message, Spoiled& spoiled) {
    all.push_back({std::string(name) + ".vpmg", Kind::tool_model, message, spoiled.bytes()});
  };
  add("calibration_negative", "calibration is negative", Spoiled(good).set("CALB", 0, 24, -0.5));
  add("calibration_not_finite", "calibration is negative, not finite",
      Spoiled(good).set("CALB", 0, 16, kNan));
  add("calibration_above_worst", "exceeds its own worst", Spoiled(good).set("CALB", 0, 8, 0.5));
}

void add_surfaces(std::vector<RefusedFile>& all, const std::vector<std::byte>& good) {
  const auto add = [&](const char* name, const char* message, Spoiled& spoiled) {
    all.push_back({std::string(name) + ".vpmg", Kind::tool_model, message, spoiled.bytes()});
  };
  add("surface_not_finite", "vertex 2 of its surface", Spoiled(good).set("SRFV", 0, 48, kNan));
  add("surface_beyond_reach", "vertex 0 of its surface", Spoiled(good).set("SRFV", 0, 0, -0.2));
  add("surface_out_of_range", "triangle 1 of its surface names vertex 8",
      Spoiled(good).set("SRFT", 0, 12, std::uint32_t{8}));
  add("surface_open", "not closed", Spoiled(good).set("SRFT", 0, 0, std::uint32_t{2}));
  add("surface_of_another", "times the tool's volume", Spoiled(good).set("SRFV", 0, 0, -0.09));
}

void add_faces(std::vector<RefusedFile>& all, const std::vector<std::byte>& good) {
  const auto add = [&](const char* name, const char* message, Spoiled& spoiled) {
    all.push_back({std::string(name) + ".vpmg", Kind::tool_model, message, spoiled.bytes()});
  };
  add("face_of_no_sample", "face of sample 8 is out of",
      Spoiled(good).set("SMPF", 1, 7 * 32, std::uint32_t{8}));
  add("face_twice", "face of sample 1 is out of order",
      Spoiled(good).set("SMPF", 1, 2 * 32, std::uint32_t{1}));
  add("face_axis_long", "no unit vector", Spoiled(good).set("SMPF", 1, 4, 1.1F));
  add("face_extent_zero", "extents out of range", Spoiled(good).set("SMPF", 1, 16, 0.0F));
  add("face_extent_not_finite", "extents out of range",
      Spoiled(good).set("SMPF", 1, 28, static_cast<float>(kNan)));
  add("face_too_wide", "extents out of range", Spoiled(good).set("SMPF", 1, 28, 0.2F));
  add("face_too_thin", "larger variance", Spoiled(good).set("SMPF", 1, 16, 0.01F));
}

void add_clouds(std::vector<RefusedFile>& all, const std::vector<std::byte>& good) {
  const auto add = [&](const char* name, const char* message, Spoiled& spoiled) {
    all.push_back({std::string(name) + ".vpmc", Kind::cloud, message, spoiled.bytes()});
  };
  add("point_not_finite", "point 0 is not finite",
      Spoiled(good).set("POSN", 0, 4, static_cast<float>(kNan)));
  add("normal_too_long", "point 1 has a normal", Spoiled(good).set("NRML", 0, 12, -2.0F));
  add("radius_negative", "point 2 has a sampling radius", Spoiled(good).set("RADI", 0, 8, -1.0F));
  add("pixel_outside", "point 0 lies outside", Spoiled(good).set("PIXL", 0, 0, std::uint32_t{12}));
  add("depth_negative", "depth image holds", Spoiled(good).set("DPTH", 0, 0, -1.0F));
  add("camera_focal_zero", "focal length", Spoiled(good).set("CAMR", 0, 0, 0.0));
  add("camera_not_rigid", "camera's pose", Spoiled(good).set("CAMR", 0, 32, 0.5));
  add("camera_too_wide", "2^32 - 1 pixels", Spoiled(good).set("CAMR", 0, 128, kMost));
  add("camera_too_high", "not as large", Spoiled(good).set("CAMR", 0, 132, std::uint32_t{4}));
}

}  // namespace

std::vector<std::byte> resealed(std::vector<std::byte> bytes) {
  return Spoiled(std::move(bytes)).bytes();
}

std::vector<RefusedFile> refused_files(const std::vector<std::byte>& packing,
                                       const std::vector<std::byte>& model,
                                       const std::vector<std::byte>& calibrated_model,
                                       const std::vector<std::byte>& model_with_surface,
                                       const std::vector<std::byte>& model_with_faces,
                                       const std::vector<std::byte>& cloud) {
  std::vector<RefusedFile> all;
  add_containers(all, packing);
  all.push_back({"cloud_as_packing.vpmc", Kind::packing,
                 "this is a cloud (.vpmc); needed is a packing (.vpmp)", cloud});
  add_packings(all, packing);
  add_models(all, model);
  add_calibrations(all, calibrated_model);
  add_surfaces(all, model_with_surface);
  add_faces(all, model_with_faces);
  add_clouds(all, cloud);
  return all;
}

}  // namespace vpm::golden
