// A folder of its own for each test, since ctest runs tests side by side in one temporary folder.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "libvpm/file/stream.h"
#include "libvpm/file/temporary_folder.h"

namespace vpm::test {

class InTemporaryFolder : public testing::Test {
 protected:
  std::string path(const std::string& name) const { return folder_.path(name); }
  std::vector<std::string> names() const {
    std::vector<std::string> all;
    for (const auto& entry : std::filesystem::directory_iterator(folder_.path()))
      all.push_back(entry.path().filename().string());
    std::sort(all.begin(), all.end());
    return all;
  }

 private:
  file::TemporaryFolder folder_;
};

inline std::string text_of(const std::string& path) {
  const std::vector<std::byte> bytes = file::read_all(path);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace vpm::test
