#include "tools/query/pairs_parts.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "libvpm/core/parallel.h"
#include "libvpm/file/checksum.h"
#include "libvpm/file/overwrite.h"
#include "libvpm/file/stream.h"
#include "libvpm/file/text.h"
#include "tools/common/mesh_plugin.h"
#include "tools/common/mesh_tool.h"

namespace vpm::tools {
namespace {

// What is said of a file, in backquotes where the API has a name.
struct SaidOfMesh {
  bool is_warning;
  std::string text;
};

// A file, or a node of one, and what became of it.
struct Source {
  std::string file, node;
  std::string content = {};  // equal for sources that are the same solid
  std::optional<SolidBody> body = {};
  std::vector<SaidOfMesh> said = {};
  std::optional<Error> fault = {};
};

// True if files of this name tell their unit.
bool has_unit(const std::string& file) {
  static const std::set<std::string> kEndings{".dae", ".glb", ".gltf", ".3mf", ".fbx"};
  return kEndings.contains(file::in_lower_case(std::filesystem::path(file).extension().string()));
}

// Runs the job of each of the sources on several threads, and keeps what it throws.
void for_each(std::vector<Source*>& sources, const std::function<void(Source&)>& job) {
  parallel_for(sources.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) try {
        job(*sources[k]);
      } catch (const Error& error) {
        sources[k]->fault.emplace(error);
      }
  });
}

// Sets `content`: the hash of the file's bytes, with the node. Text glTF may keep its buffers in
// files beside it, so the bytes alone do not tell the solid, and the file's path counts too.
void identify(Source& source) {
  source.content = file::content_hash({file::read_all(source.file)}) + source.node;
  if (source.file.ends_with(".gltf")) source.content += '\0' + source.file;
  // Nor do they where the format has a unit of its own, and the same bytes under another name have
  // that of the assembly.
  if (has_unit(source.file)) source.content += '\0';
}

void keep_what_is_said(void* source, bool is_warning, const char* text) {
  static_cast<Source*>(source)->said.push_back({is_warning, text});
}

// Reads the mesh as it is, or, where it is no solid, repaired: what is sound keeps its volume.
void read_mesh(Source& source, SolidOptions options, bool with_force) {
  static const auto read = reinterpret_cast<ReadSolid>(function_of_meshes(kReadSolid));
  if (options.scale && has_unit(source.file)) options.scale = 1;
  options.node = source.node;
  const Repair repair = std::exchange(options.repair, Repair::none);
  PackingFault fault;
  const auto is_read = [&] {
    fault = {};
    return read(source.file.c_str(), &options, with_force, keep_what_is_said, &source, &source.body,
                &fault);
  };
  if (is_read()) return;
  if (repair != Repair::none) {
    options.repair = repair;
    source.said.clear();
    if (is_read()) return;
  }
  throw Error(static_cast<ErrorKind>(fault.kind), fault.problem, fault.where, fault.hint);
}

void prepare(Source& source, const SolidOptions& options, bool with_force) {
  if (!file::is_container(source.file)) return read_mesh(source, options, with_force);
  try {
    source.body.emplace(Tool::read(source.file), with_force);
  } catch (const Error& error) {
    const std::string& where = error.where();
    throw Error(error.kind(), error.problem(), where.empty() ? source.file : where, error.hint());
  }
}

// Returns the text with the unit in place of the scale that would mend the size.
std::string in_words_of_units(std::string text, double metres) {
  const std::size_t at = text.find("`scale` ");
  if (at == text.npos) return text;
  const std::size_t end = std::min(text.find_first_of(" ;,", at + 8), text.size());
  const bool is_millimetre = metres == 1 && text.substr(at + 8, end - at - 8) == "0.001";
  return text.replace(at, end - at, is_millimetre ? "--unit mm" : "another --unit");
}

bool is_of_size(const SaidOfMesh& said) {
  return said.is_warning && said.text.find("`scale` ") != said.text.npos;
}

// Doubts of a size are left out unless all have one, and one is enough then: a tiny part beside
// others is right.
void keep_one_doubt_of_size(const std::vector<Source*>& sources) {
  const bool doubts_all = std::ranges::all_of(sources, [](const Source* source) {
    return !source->body || std::ranges::any_of(source->said, is_of_size);
  });
  bool keeps = doubts_all;
  for (Source* source : sources)
    std::erase_if(source->said, [&](const SaidOfMesh& said) {
      return is_of_size(said) && !std::exchange(keeps, false);
    });
}

// Prints what is said of the sources: warnings, of many the first few, and the rest with --verbose.
void tell(const Program& program, const std::vector<Source*>& sources, double metres) {
  constexpr std::size_t kMostShown = 5;
  keep_one_doubt_of_size(sources);
  std::size_t warnings = 0;
  for (const Source* source : sources)
    for (const auto& [is_warning, text] : source->said) {
      const std::string said = source->file + ": " + in_words_of_units(text, metres);
      warnings += is_warning ? 1 : 0;
      if (is_warning && (warnings <= kMostShown || program.common().verbose))
        program.warn(said);
      else if (!is_warning)
        program.detail(said);
    }
  if (warnings > kMostShown && !program.common().verbose)
    program.warn(std::to_string(warnings - kMostShown) +
                 " more such warnings; --verbose shows them");
}

// The sources of an assembly's parts, each once.
class Sources {
 public:
  explicit Sources(const Assembly& assembly) {
    std::map<std::pair<std::string, std::string>, Source*> known;
    for (const AssemblyPart& part : assembly.parts) {
      Source*& source = known[{part.file, part.node}];
      if (source == nullptr)
        source = all_.emplace_back(std::make_unique<Source>(Source{part.file, part.node})).get();
      of_part_.push_back(source);
    }
  }

  // Reads those that differ, and gives the others what they have in common.
  void prepare_all(const SolidOptions& options, bool with_force) {
    std::vector<Source*> files;
    for (const auto& source : all_) files.push_back(source.get());
    for_each(files, identify);
    std::map<std::string, Source*> first;
    for (Source* source : files)
      if (!source->fault && first.try_emplace(source->content, source).second)
        solids_.push_back(source);
    for_each(solids_, [&](Source& source) { prepare(source, options, with_force); });
    for (Source* source : files) {
      if (source->fault || source->body) continue;
      source->body = first[source->content]->body;
      source->fault = first[source->content]->fault;
    }
  }

  const std::vector<Source*>& solids() const { return solids_; }
  const Source& of_part(std::size_t k) const { return *of_part_[k]; }

 private:
  std::vector<std::unique_ptr<Source>> all_;
  std::vector<Source*> of_part_;
  std::vector<Source*> solids_;  // those that differ
};

// Loads what reads meshes, if a part is one.
void load_reader(const Program& program, const Assembly& assembly) {
  const auto is_mesh = [](const AssemblyPart& part) { return !file::is_container(part.file); };
  if (std::ranges::any_of(assembly.parts, is_mesh))
    reinterpret_cast<UseThreads>(function_of_meshes(kUseThreads))(program.common().threads);
}

}  // namespace

PreparedParts prepare_parts(const Program& program, const Assembly& assembly, double metres,
                            const SolidOptions& options, bool with_force) {
  load_reader(program, assembly);
  Sources sources(assembly);
  sources.prepare_all(options, with_force);
  tell(program, sources.solids(), metres);
  PreparedParts prepared;
  for (std::size_t k = 0; k < assembly.parts.size(); ++k) {
    const AssemblyPart& part = assembly.parts[k];
    const Source& source = sources.of_part(k);
    if (source.fault && source.fault->kind() != ErrorKind::refused) throw *source.fault;
    if (source.fault) {
      program.error("part '" + part.name +
                    "' is left out: " + in_words_of_units(source.fault->what(), metres));
      continue;
    }
    const auto [x, y, z] = part.pose.translation;
    prepared.parts.push_back(
        {*source.body, {part.pose.rotation, {metres * x, metres * y, metres * z}}});
    prepared.places.push_back(k);
  }
  return prepared;
}

}  // namespace vpm::tools
