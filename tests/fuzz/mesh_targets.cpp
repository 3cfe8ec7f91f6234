#include <string>
#include <string_view>
#include <vector>

#include "libvpm/mesh/mesh_check.h"
#include "libvpm/mesh/mesh_parsers.h"
#include "libvpm/mesh/voxel_repair.h"
#include "libvpm/packing/packer.h"
#include "tests/fuzz/targets.h"
#include "tests/mesh/zip_file.h"

namespace vpm::fuzz {
namespace {

constexpr std::size_t kMostToSolid = 64;  // polygons that are made a solid
constexpr std::size_t kMostToPack = 40;   // triangles that are packed
// One solid of so many is packed, or repaired by voxels: both take ten times as long as the rest.
constexpr std::size_t kPackedOf = 16, kVoxelsOf = 16;

void expect_sound(const RawMesh& mesh) {
  for (const std::uint32_t corner : mesh.corners)
    if (corner >= mesh.vertices.size()) fail("a corner is out of range");
  for (const Vec3& vertex : mesh.vertices)
    if (!is_finite(vertex)) fail("a vertex is not finite");
  std::size_t end = 0;
  for (const std::size_t next : mesh.polygon_end) {
    if (next < end || next > mesh.corners.size()) fail("polygons do not ascend");
    end = next;
  }
}

// True if a process of its own may read this, which takes as long as a hundred files of other
// formats: the target `scene` has such inputs.
bool is_scene(Bytes input) {
  return scene_by_content(text_of(input)).has_value();
}

template <class Parser>
void run_mesh(const Parser& parse) {
  expect_error_at_most([&] {
    const RawMesh mesh = parse();
    expect_sound(mesh);
    if (mesh.polygon_count() <= kMostToSolid) make_solid(mesh);
  });
}

void run_format(Bytes input, const char* name) {
  if (!is_scene(input)) run_mesh([&] { return parse_mesh(input, name); });
}

}  // namespace

void run_obj(Bytes input) {
  run_format(input, "x.obj");
}
void run_off(Bytes input) {
  run_format(input, "x.off");
}
void run_ply(Bytes input) {
  run_format(input, "x.ply");
}
void run_stl(Bytes input) {
  run_format(input, "x.stl");
}
void run_om(Bytes input) {
  run_mesh([&] { return parse_om(text_of(input), "x.om"); });
}
void run_scene(Bytes input) {
  const bool is_text_of_fbx = text_of(input).starts_with(';');
  run_mesh([&] { return parse_mesh(input, is_text_of_fbx ? "x.fbx" : "x.gltf"); });
}

void run_threemf(Bytes input) {
  constexpr std::string_view kBetween = "\n--\n";
  std::vector<test::ZippedFile> files;
  const std::string text = text_of(input);
  std::string_view rest = text;
  for (const char* const path :
       {"3D/3dmodel.model", "3D/Objects/a.model", "Metadata/model_settings.config",
        "Metadata/Slic3r_PE_model.config"}) {
    const std::size_t end = rest.find(kBetween);
    files.push_back({path, std::string(rest.substr(0, end))});
    if (end == rest.npos) break;
    rest.remove_prefix(end + kBetween.size());
  }
  const std::string archive = test::zip(files);
  run_mesh([&] { return parse_threemf(archive, "x.3mf", ""); });
}

void run_solid(Bytes input) {
  if (input.empty() || is_scene(input.subspan(1))) return;
  const auto choice = static_cast<unsigned>(input[0]);
  expect_error_at_most([&] {
    SolidOptions options;
    Choice rare(input);
    const bool has_voxels = rare.one_of(kVoxelsOf) == 0;
    options.repair = static_cast<Repair>(choice % (has_voxels ? 4 : 2));
    options.repair_voxels = kMinRepairVoxels;
    if ((choice & 4) != 0) options.weld = 1e-6;
    if ((choice & 8) != 0) options.scale = 0.001;
    const CheckedSolid checked = make_solid(parse_mesh(input.subspan(1), "x.obj"), options);
    if (checked.solid.triangles.size() > kMostToPack) return;
    if (rare.one_of(kPackedOf) != 0) return;
    PackOptions pack_options;
    pack_options.spheres = 3;
    pack_options.enclosure = &checked.enclosure;
    const PackResult packed = pack(checked.solid, pack_options);
    for (const Sphere& sphere : packed.spheres)
      if (!is_finite(sphere.center) || !(sphere.radius > 0)) fail("a sphere is not sound");
  });
}

}  // namespace vpm::fuzz
