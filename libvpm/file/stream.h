// Reads and writes whole files; "-" is standard input or output.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "libvpm/core/error.h"

namespace vpm::file {

// Limits what is read from a pipe or device, which may go on for ever: 1 GiB.
inline constexpr std::size_t kMostOfAPipe = std::size_t{1} << 30;

// Returns the bytes of a file. Throws Error(refused) if it does not exist, is a folder, cannot be
// read, changes while it is read, or is a pipe or device of more than `most_of_a_pipe` bytes.
std::vector<std::byte> read_all(const std::string& path, std::size_t most_of_a_pipe = kMostOfAPipe);

// Returns the descriptor that an output path names: "-", /dev/stdout, /dev/stderr, /dev/fd/3. Empty
// for all other paths.
std::optional<int> descriptor_of(std::string_view path);

// Failure to write because the reader of a pipe has gone: it wants no more, which is no mistake.
class ClosedPipe : public Error {
 public:
  explicit ClosedPipe(const std::string& what) : Error(ErrorKind::cannot_write, what) {}
};

// Output written in parts. Regular files are atomic: whatever interrupts the run leaves the old
// file or the whole new one, since parts go to a temporary file beside it. Pipes, devices
// (/dev/stdout, /dev/null) and "-" receive each part at once. Not thread-safe.
class Output {
 public:
  // Opens the output; blocks on a named pipe until it has a reader. Throws Error(cannot_write), as
  // do append() and finish(); these throw ClosedPipe where it applies.
  explicit Output(const std::string& path);
  // Discards the output unless finish() was called: the old file stays.
  ~Output();
  Output(const Output&) = delete;
  Output& operator=(const Output&) = delete;

  void append(std::span<const std::byte> bytes);
  void append(std::string_view text);
  void finish();

  class Target;

 private:
  std::unique_ptr<Target> target_;
};

// Writes a whole output at once and finishes it.
void write_all(const std::string& path, std::span<const std::byte> bytes);
void write_all(const std::string& path, std::string_view text);

// Removes the temporary files of unfinished outputs. Async-signal-safe, for signal handlers.
void remove_unfinished_output();

// Returns the bytes of memory that a library may take to decode a file: 64 times its size and
// 256 MB, which no sound file comes near.
inline std::uint64_t most_memory(std::uint64_t file_bytes) {
  return 64 * file_bytes + 256'000'000;
}

}  // namespace vpm::file
