#include "libvpm/model/tool_model.h"

#include <algorithm>

#include "libvpm/core/error.h"
#include "libvpm/file/container.h"

namespace vpm {
namespace {

constexpr file::ChunkId kTool("TOOL"), kSpheres("SPHR"), kLevels("LEVL");
constexpr file::ChunkId kEdgeBegin("EDGB"), kNeighbors("EDGN"), kNodes("NODE"), kLeaves("LEAF");
constexpr file::ChunkId kGridBegin("GRDB"), kGridSpheres("GRDS");
constexpr file::ChunkId kCellVolume("SHRV"), kCellCentroid("SHRC"), kCellReach("SHRR");
constexpr file::ChunkId kBlockBegin("BLKB"), kBlocks("BLCK"), kSamples("SMPL"), kFaces("SMPF");
constexpr file::ChunkId kCalibration("CALB");
constexpr file::ChunkId kSurfaceVertices("SRFV"), kSurfaceTriangles("SRFT");
constexpr file::ChunkId kMeshVertices("MSHV"), kMeshTriangles("MSHT");

struct ToolRecord {
  double volume;
  Vec3 center_of_mass;
  double radius;
};
struct LevelRecord {
  double epsilon;
  Vec3 grid_low;
  double grid_cell;
  std::uint32_t grid_nx, grid_ny, grid_nz;
  std::uint32_t bridges, components_before, sphere_count;
};
static_assert(sizeof(ToolRecord) == 40 && sizeof(LevelRecord) == 64 &&
                  sizeof(HierarchyNode) == 48 && sizeof(CellBlock) == 24 &&
                  sizeof(CellSample) == 24 && sizeof(SampleFace) == 32 && sizeof(Sphere) == 32 &&
                  sizeof(Vec3) == 24 && sizeof(LevelError) == 24 && sizeof(Vec3f) == 12 &&
                  sizeof(Triangle) == 12,
              "chunks hold these types as they lie in memory");

LevelRecord record_of(const Level& level) {
  return {level.epsilon, level.grid.low, level.grid.cell,         level.grid.nx,     level.grid.ny,
          level.grid.nz, level.bridges,  level.components_before, level.sphere_count};
}

Level level_of(const LevelRecord& record, const file::Reader& reader, std::uint32_t k) {
  Level level;
  level.epsilon = record.epsilon;
  level.bridges = record.bridges;
  level.components_before = record.components_before;
  level.sphere_count = record.sphere_count;
  level.graph = {reader.read<std::uint32_t>(kEdgeBegin, k),
                 reader.read<std::uint32_t>(kNeighbors, k)};
  level.hierarchy = {reader.read<HierarchyNode>(kNodes, k), reader.read<std::uint32_t>(kLeaves, k)};
  level.grid = {record.grid_low,
                record.grid_cell,
                record.grid_nx,
                record.grid_ny,
                record.grid_nz,
                reader.read<std::uint32_t>(kGridBegin, k),
                reader.read<std::uint32_t>(kGridSpheres, k)};
  level.cell_volume = reader.read<double>(kCellVolume, k);
  level.cell_centroid = reader.read<Vec3>(kCellCentroid, k);
  level.cell_radius = reader.read<double>(kCellReach, k);
  level.block_begin = reader.read<std::uint32_t>(kBlockBegin, k);
  level.blocks = reader.read<CellBlock>(kBlocks, k);
  level.samples = reader.read<CellSample>(kSamples, k);
  if (reader.has(kFaces, k)) level.faces = reader.read<SampleFace>(kFaces, k);
  return level;
}

void add_level(file::Writer& writer, const Level& level, std::uint32_t k) {
  writer.add(kEdgeBegin, k, std::span(level.graph.begin));
  writer.add(kNeighbors, k, std::span(level.graph.neighbors));
  writer.add(kNodes, k, std::span(level.hierarchy.nodes));
  writer.add(kLeaves, k, std::span(level.hierarchy.leaves));
  writer.add(kGridBegin, k, std::span(level.grid.begin));
  writer.add(kGridSpheres, k, std::span(level.grid.spheres));
  writer.add(kCellVolume, k, std::span(level.cell_volume));
  writer.add(kCellCentroid, k, std::span(level.cell_centroid));
  writer.add(kCellReach, k, std::span(level.cell_radius));
  writer.add(kBlockBegin, k, std::span(level.block_begin));
  writer.add(kBlocks, k, std::span(level.blocks));
  writer.add(kSamples, k, std::span(level.samples));
  if (!level.faces.empty()) writer.add(kFaces, k, std::span(level.faces));
}

ToolModel model_of(const file::Reader& reader) {
  const std::vector<ToolRecord> tool = reader.read<ToolRecord>(kTool, 0);
  if (tool.size() != 1)
    reader.refuse_file("chunk TOOL must hold one record", "make the file again");
  ToolModel model;
  model.volume = tool[0].volume;
  model.center_of_mass = tool[0].center_of_mass;
  model.radius = tool[0].radius;
  const nlohmann::json& header = reader.header();
  const nlohmann::json hash = header.value("solid_hash", nlohmann::json());
  if (!hash.is_string()) reader.refuse_file("the header has no solid_hash", "make the file again");
  model.solid_hash = hash.get<std::string>();
  model.provenance = header.value("provenance", nlohmann::json());
  model.spheres = reader.read<Sphere>(kSpheres, 0);
  const std::vector<LevelRecord> records = reader.read<LevelRecord>(kLevels, 0);
  for (std::uint32_t k = 0; k < records.size(); ++k)
    model.levels.push_back(level_of(records[k], reader, k));
  if (reader.has(kCalibration, 0)) model.calibration = reader.read<LevelError>(kCalibration, 0);
  if (reader.has(kSurfaceVertices, 0) || reader.has(kSurfaceTriangles, 0)) {
    model.surface = {reader.read<Vec3>(kSurfaceVertices, 0),
                     reader.read<Triangle>(kSurfaceTriangles, 0)};
    if (model.surface.triangles.empty()) reader.refuse_file("its surface has no triangles");
  }
  validate(model, reader.name());
  return model;
}

void add_mesh(file::Writer& writer, const Solid& mesh, Vec3 center_of_mass) {
  std::vector<Vec3f> vertices;
  for (const Vec3& p : mesh.vertices) vertices.push_back(narrow(p - center_of_mass));
  writer.add(kMeshVertices, 0, std::span(std::as_const(vertices)));
  writer.add(kMeshTriangles, 0, std::span(mesh.triangles));
}

}  // namespace

const Level& ToolModel::level(std::uint32_t sphere_count) const {
  if (levels.empty()) throw Error(ErrorKind::invalid_argument, "the tool model has no levels");
  if (sphere_count == 0) return levels.back();
  std::string there_are;
  for (const Level& level : levels) {
    if (level.sphere_count == sphere_count) return level;
    there_are += (there_are.empty() ? "" : ", ") + std::to_string(level.sphere_count);
  }
  throw Error(ErrorKind::invalid_argument, "the tool model has no level of " +
                                               std::to_string(sphere_count) + " spheres; it has " +
                                               there_are);
}

ToolModel read_tool_model(const std::string& path) {
  return model_of(file::Reader(path, file::Kind::tool_model));
}

ToolModel parse_tool_model(std::vector<std::byte> bytes, const std::string& name) {
  return model_of(file::Reader(std::move(bytes), name, file::Kind::tool_model));
}

Solid read_display_mesh(const std::string& path) {
  const file::Reader reader(path, file::Kind::tool_model);
  Solid mesh;
  if (!reader.has(kMeshVertices, 0)) return mesh;
  const std::vector<ToolRecord> tool = reader.read<ToolRecord>(kTool, 0);
  if (tool.size() != 1) reader.refuse_file("chunk TOOL must hold one record; make the file again");
  for (const Vec3f& p : reader.read<Vec3f>(kMeshVertices, 0)) {
    if (!is_finite(p)) reader.refuse_file("a vertex of its mesh for views is not finite");
    mesh.vertices.push_back(tool[0].center_of_mass + widen(p));
  }
  mesh.triangles = reader.read<Triangle>(kMeshTriangles, 0);
  for (const Triangle& t : mesh.triangles) {
    if (std::ranges::max(t) >= mesh.vertices.size())
      reader.refuse_file("a triangle of its mesh for views has a vertex that is not there");
  }
  return mesh;
}

void write_tool_model(const std::string& path, const ToolModel& model, const Solid& mesh) {
  validate(model, path);
  file::Writer writer(
      file::Kind::tool_model,
      {{"unit", "m"}, {"solid_hash", model.solid_hash}, {"provenance", model.provenance.json()}});
  const ToolRecord tool{model.volume, model.center_of_mass, model.radius};
  writer.add(kTool, 0, std::span(&tool, 1));
  writer.add(kSpheres, 0, std::span(model.spheres));
  std::vector<LevelRecord> records;
  for (const Level& level : model.levels) records.push_back(record_of(level));
  writer.add(kLevels, 0, std::span(std::as_const(records)));
  for (std::uint32_t k = 0; k < model.levels.size(); ++k) add_level(writer, model.levels[k], k);
  if (!model.calibration.empty()) writer.add(kCalibration, 0, std::span(model.calibration));
  if (!model.surface.triangles.empty()) {
    writer.add(kSurfaceVertices, 0, std::span(model.surface.vertices));
    writer.add(kSurfaceTriangles, 0, std::span(model.surface.triangles));
  }
  if (!mesh.triangles.empty()) add_mesh(writer, mesh, model.center_of_mass);
  writer.write(path);
}

}  // namespace vpm
