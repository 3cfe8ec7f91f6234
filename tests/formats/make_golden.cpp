// vpm-make-golden FORMATS: writes the golden and the refused files into the folder formats/. Run it
// only for a new layout version; files of the old one stay and must still be read.
#include <filesystem>
#include <iostream>

#include "libvpm/cloud/cloud.h"
#include "libvpm/file/stream.h"
#include "libvpm/model/packing.h"
#include "libvpm/model/tool_model.h"
#include "tests/formats/content_dump.h"
#include "tests/formats/golden_content.h"
#include "tests/formats/refused_files.h"

namespace {

namespace fs = std::filesystem;
using namespace vpm;

void write_model(const std::string& path, const ToolModel& model) {
  write_tool_model(path, model);
}

template <class Content>
void write_pair(const fs::path& path, const Content& content,
                void (*write)(const std::string&, const Content&)) {
  write(path.string(), content);
  file::write_all(path.string() + ".json", golden::dump(content).dump(1) + "\n");
}

const char* name_of(file::Kind kind) {
  switch (kind) {
    case file::Kind::packing:
      return "packing";
    case file::Kind::tool_model:
      return "tool model";
    case file::Kind::cloud:
      return "cloud";
  }
  return "unknown";
}

void write_refused(const fs::path& golden, const fs::path& folder) {
  nlohmann::json manifest = nlohmann::json::array();
  for (const golden::RefusedFile& file :
       golden::refused_files(file::read_all((golden / "cube.vpmp").string()),
                             file::read_all((golden / "cube.vpmg").string()),
                             file::read_all((golden / "calibrated.vpmg").string()),
                             file::read_all((golden / "surface.vpmg").string()),
                             file::read_all((golden / "faces.vpmg").string()),
                             file::read_all((golden / "wall.vpmc").string()))) {
    file::write_all((folder / file.name).string(), std::span<const std::byte>(file.bytes));
    manifest.push_back(
        {{"file", file.name}, {"read_as", name_of(file.kind)}, {"message", file.message}});
  }
  file::write_all((folder / "manifest.json").string(), manifest.dump(1) + "\n");
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: vpm-make-golden FORMATS\n";
    return 2;
  }
  try {
    const fs::path golden = fs::path(argv[1]) / "golden" / "v1",
                   refused = fs::path(argv[1]) / "refused";
    fs::create_directories(golden);
    fs::create_directories(refused);
    write_pair(golden / "cube.vpmp", golden::cube_packing(), write_packing);
    write_pair(golden / "cube.vpmg", golden::cube_model(), write_model);
    write_pair(golden / "calibrated.vpmg", golden::calibrated_cube_model(), write_model);
    write_pair(golden / "surface.vpmg", golden::cube_model_with_surface(), write_model);
    write_pair(golden / "faces.vpmg", golden::cube_model_with_faces(), write_model);
    write_pair(golden / "wall.vpmc", golden::wall_cloud(), write_cloud);
    write_pair(golden / "scattered.vpmc", golden::scattered_cloud(), write_cloud);
    write_refused(golden, refused);
  } catch (const std::exception& fault) {
    std::cerr << "vpm-make-golden: error: " << fault.what() << '\n';
    return 1;
  }
  return 0;
}
