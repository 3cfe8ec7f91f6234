#pragma once

#include <cstdio>
#include <string>

#include "libvpm/core/error.h"
#include "libvpm/file/stream.h"

namespace vpm::tools {

// Results to a pipe or terminal line by line, to a file whole at the end.
class ResultSink {
 public:
  explicit ResultSink(const std::string& path) : path_(path) {}
  void line(const std::string& text) {
    if (path_ != "-") {
      held_ += text;
    } else if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() ||
               std::fflush(stdout) != 0) {
      throw Error(ErrorKind::cannot_write,
                  "standard output cannot be written: the reader is gone, or the disk is full");
    }
  }
  void finish() const {
    if (path_ != "-") file::write_all(path_, held_);
  }

 private:
  std::string path_, held_;
};

}  // namespace vpm::tools
