// Whole files in and out; "-" is standard input or output.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace vpm::file {

// Throws Error(refused) where the file is not there, is a folder, or cannot be read.
std::vector<std::byte> read_all(const std::string& path);

// Of a path that leads to a descriptor of this process, as an output: "-", /dev/stdout, /dev/fd/3.
std::optional<int> descriptor_of(std::string_view path);

// What is written in parts. Atomic for a path: the old file or the whole new one, whatever
// interrupts the run; parts wait in a temporary file beside it. A pipe, a device (/dev/stdout,
// /dev/null) and "-" are written straight, each part at once. One thread at a time.
class Output {
 public:
  // Throws Error(cannot_write), as append() and finish() do. The path of a pipe waits for a reader.
  explicit Output(const std::string& path);
  ~Output();  // without finish() the old file stays, or none
  Output(const Output&) = delete;
  Output& operator=(const Output&) = delete;

  void append(std::span<const std::byte> bytes);
  void append(std::string_view text);
  void finish();

  class Target;

 private:
  std::unique_ptr<Target> target_;
};

// One part, and finished.
void write_all(const std::string& path, std::span<const std::byte> bytes);
void write_all(const std::string& path, std::string_view text);

// Removes the temporary files of outputs that are not finished. For signal handlers:
// async-signal-safe.
void remove_unfinished_output();

}  // namespace vpm::file
