// Folder for temporary files.
#pragma once

#include <stdlib.h>

#include <filesystem>
#include <string>
#include <system_error>

#include "libvpm/core/error.h"

namespace vpm::file {

// Makes a folder of its own in the system's temporary folder, and removes it with its contents at
// the end. Throws Error(cannot_write) if it cannot be made.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    // The X's are replaced by mkdtemp.
    std::error_code fault;
    std::string name = (std::filesystem::temp_directory_path(fault) / "vpm-XXXXXX").string();
    if (fault)
      throw Error(ErrorKind::cannot_write,
                  "there is no folder for temporary files: " + fault.message(), {}, "set TMPDIR");
    if (::mkdtemp(name.data()) == nullptr)
      throw Error(ErrorKind::cannot_write, "cannot make a folder like " + name);
    folder_ = name;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::filesystem::path& path() const { return folder_; }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }

 private:
  std::filesystem::path folder_;
};

}  // namespace vpm::file
