// Reads the container of recordings in MCAP (mcap.dev/spec): records one after the other, most of
// them in chunks, plain or compressed by LZ4 or zstd. Its index is not needed.
#pragma once

#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <vector>

#include "libvpm/import/remark.h"
#include "libvpm/recording/mcap/byte_cursor.h"

namespace vpm::mcap {

// What messages of one source are: "/camera/depth/image_rect_raw", "sensor_msgs/msg/Image", "cdr".
struct Channel {
  std::string topic, type, encoding;
};

// Where a message's bytes are: at an offset, in the records of the chunk at a place of the file, or
// without a chunk (0) in the file.
struct Place {
  std::uint64_t chunk = 0, offset = 0, size = 0;
};

struct Message {
  const Channel& channel;
  std::int64_t log_time = 0;  // ns, when it was recorded
  Bytes bytes;
  Place place;
};

// A file whose lengths are not believed: none of them takes memory beyond what is there.
class File {
 public:
  // Throws Error(refused) if it cannot be read.
  explicit File(std::string path);

  // Shows all channels and messages in the order of the file, as far as that goes, without chunks
  // that are damaged. Returns what was left out, and why; a message that `see_message` refuses
  // without a hint counts as damaged. Throws what else that throws, and Error(refused) if reading
  // fails or a compression is unknown.
  Remarks scan(const std::function<void(const Channel&)>& see_channel,
               const std::function<void(const Message&)>& see_message) const;

  // Returns the bytes of a message that scan() showed. Keeps the last chunk, where the next message
  // often is. Thread-safe. Throws Error(refused) if the file has changed.
  std::vector<std::byte> read(const Place& place) const;

 private:
  std::string path_;
  std::uint64_t size_ = 0;
  mutable std::mutex mutex_;
  mutable std::uint64_t kept_chunk_ = 0;
  mutable std::vector<std::byte> kept_records_;
};

// Returns the files of a recording: the file itself if it is MCAP by its first bytes, or those of a
// folder that end in .mcap, by name; none if it is neither.
std::vector<std::string> files_of(const std::string& path);

}  // namespace vpm::mcap
