// Reads the container of recordings in MCAP (mcap.dev/spec): records one after the other, most of
// them in chunks. Its index is not needed.
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <vector>

#include "libvpm/import/remark.h"
#include "libvpm/recording/mcap/byte_cursor.h"

namespace vpm::mcap {

// Source of messages: "/camera/depth/image_rect_raw", "sensor_msgs/msg/Image", "cdr".
struct Channel {
  std::string topic, type, encoding;
};

// Where a message's bytes are: at an offset in the records of the chunk at a place of the file, or,
// if that is 0, in the file.
struct Place {
  std::uint64_t chunk = 0, offset = 0, size = 0;
};

struct Message {
  const Channel& channel;
  std::uint64_t log_time = 0;  // ns, when it was recorded
  Bytes bytes;
  Place place;
};

// Records of a chunk. The memory is not touched before bytes come, whatever size is declared.
struct Records {
  std::unique_ptr<std::byte[]> bytes;
  std::size_t size = 0;
};

// A file whose lengths are not believed: none of them takes memory beyond what is there.
class File {
 public:
  // Throws Error(refused) if it cannot be read.
  explicit File(std::string path);

  // Shows all messages in the order of the file, as far as that goes, without chunks that are
  // damaged. Returns what was left out, and why: a message for which `see` throws Damage, too.
  // Throws what else that throws; Error(refused), naming the file, if reading fails or a
  // compression is unknown.
  Remarks scan(const std::function<void(const Message&)>& see) const;

  // Returns the bytes of a message that scan() showed. Keeps its chunk, for those that follow it
  // there. Thread-safe. Throws Error(refused) if the file has changed.
  std::vector<std::byte> read(const Place& place) const;

 private:
  std::string path_;
  std::uint64_t size_ = 0;
  mutable std::mutex busy_;
  mutable std::uint64_t opened_ = 0;  // place of the chunk that was read last
  mutable Records records_;           // of it
};

// Returns the files of a recording: the file itself if it is MCAP by its first bytes, or those of a
// folder that end in .mcap, by name; none if it is neither.
std::vector<std::string> files_of(const std::string& path);

}  // namespace vpm::mcap
