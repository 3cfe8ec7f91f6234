// Where a test writes files: ctest runs tests side by side, and their temporary folder is one.
#pragma once

#include <gtest/gtest.h>
#include <stdlib.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

#include "libvpm/file/stream.h"

namespace vpm::test {

// A fresh folder of nobody else's, removed at the end.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = testing::TempDir() + "vpm-test-XXXXXX";
    if (::mkdtemp(name.data()) == nullptr)
      throw std::system_error(errno, std::generic_category(), name);
    folder_ = name;
  }
  ~TemporaryFolder() { std::filesystem::remove_all(folder_); }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  std::vector<std::string> names() const {
    std::vector<std::string> all;
    for (const auto& entry : std::filesystem::directory_iterator(folder_))
      all.push_back(entry.path().filename().string());
    std::sort(all.begin(), all.end());
    return all;
  }

 private:
  std::filesystem::path folder_;
};

class InTemporaryFolder : public testing::Test {
 protected:
  std::string path(const std::string& name) const { return folder_.path(name); }
  std::vector<std::string> names() const { return folder_.names(); }

 private:
  TemporaryFolder folder_;
};

inline std::string text_of(const std::string& path) {
  const std::vector<std::byte> bytes = file::read_all(path);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace vpm::test
