#include "libvpm/recording/mcap/mcap_file.h"

#include <lz4frame.h>
#include <zlib.h>
#include <zstd.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <string_view>
#include <system_error>
#include <utility>

#include "libvpm/file/stream.h"
#include "libvpm/file/text.h"

namespace vpm::mcap {
namespace {

namespace fs = std::filesystem;
constexpr std::string_view kMagic("\x89MCAP0\r\n", 8);
constexpr std::uint64_t kMostRecord = std::uint64_t{1} << 30U;  // bytes; larger ones are left out
constexpr std::uint64_t kHeader = 9;                            // bytes: kind and length
enum Kind : std::uint8_t {
  invalid,
  footer = 2,
  schema,
  channel,
  message,
  chunk,
  chunk_index = 8,
  data_end = 15
};

std::vector<std::byte> read_part(std::ifstream& file, std::uint64_t at, std::uint64_t count) {
  std::vector<std::byte> bytes(count);
  if (file && static_cast<std::uint64_t>(file.tellg()) != at)
    file.seekg(static_cast<std::streamoff>(at));
  file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(count));
  if (!file) refuse("the recording cannot be read, or it has changed", {}, "copy it again");
  return bytes;
}

// Calls `step` until input or output end, or it returns 0 or an error (true by `is_error`). It
// takes from the input, gives to the output and sets both counts to how much. Returns what came.
template <class Step, class IsError>
std::vector<std::byte> decode(Bytes bytes, std::uint64_t most, Step step, IsError is_error) {
  constexpr std::uint64_t kFirst = 65536, kRatio = 4;
  std::vector<std::byte> out(std::min(most, kFirst + kRatio * bytes.size()));
  std::size_t taken = 0, given = 0;
  while (true) {
    std::size_t from = bytes.size() - taken, to = out.size() - given;
    const std::size_t more = step(out.data() + given, to, bytes.data() + taken, from);
    taken += from;
    given += to;
    if (more == 0 || is_error(more) || (from == 0 && to == 0) || given == most) break;
    if (given == out.size()) out.resize(std::min<std::uint64_t>(most, 2 * out.size()));
  }
  out.resize(given);
  return out;
}

std::vector<std::byte> decode_lz4(Bytes bytes, std::uint64_t most) {
  LZ4F_dctx* made = nullptr;
  LZ4F_createDecompressionContext(&made, LZ4F_VERSION);
  const std::unique_ptr<LZ4F_dctx, LZ4F_errorCode_t (*)(LZ4F_dctx*)> context(
      made, LZ4F_freeDecompressionContext);
  const auto step = [&](void* to, std::size_t& given, const void* from, std::size_t& taken) {
    return LZ4F_decompress(context.get(), to, &given, from, &taken, nullptr);
  };
  return decode(bytes, most, step, LZ4F_isError);
}

std::vector<std::byte> decode_zstd(Bytes bytes, std::uint64_t most) {
  const std::unique_ptr<ZSTD_DStream, std::size_t (*)(ZSTD_DStream*)> stream(ZSTD_createDStream(),
                                                                             ZSTD_freeDStream);
  const auto step = [&](void* to, std::size_t& given, const void* from, std::size_t& taken) {
    ZSTD_inBuffer in{from, taken, 0};
    ZSTD_outBuffer out{to, given, 0};
    const std::size_t more = ZSTD_decompressStream(stream.get(), &out, &in);
    taken = in.pos;
    given = out.pos;
    return more;
  };
  return decode(bytes, most, step, ZSTD_isError);
}

struct Chunk {
  std::vector<std::byte> records;
  bool is_sound = false;  // all of it is there, and its checksum is right
};

// Takes a chunk's record, of which the end may be missing.
Chunk open_chunk(Bytes record) {
  ByteCursor cursor(record);
  cursor.take(16);  // times of its first and last message
  const auto size = cursor.number<std::uint64_t>();
  const auto checksum = cursor.number<std::uint32_t>();
  const std::string compression = cursor.text();
  const auto stored = cursor.number<std::uint64_t>();
  const Bytes bytes = cursor.take(std::min<std::uint64_t>(stored, cursor.left()));
  Chunk chunk;
  if (size > std::min(kMostRecord, file::most_memory(record.size()))) return chunk;
  if (compression == "lz4")
    chunk.records = decode_lz4(bytes, size);
  else if (compression == "zstd")
    chunk.records = decode_zstd(bytes, size);
  else if (compression.empty())
    chunk.records.assign(bytes.begin(), bytes.end());
  else
    refuse("its chunks are compressed by " + file::shown(compression), {},
           "compress it by zstd: mcap compress IN.mcap -o OUT.mcap");
  const auto* const data = reinterpret_cast<const Bytef*>(chunk.records.data());
  chunk.is_sound = chunk.records.size() == size &&
                   (checksum == 0 || crc32_z(0, data, chunk.records.size()) == checksum);
  return chunk;
}

// Follows the records of a file, and counts those that are damaged.
struct Scan {
  const std::function<void(const Channel&)>& see_channel;
  const std::function<void(const Message&)>& see_message;
  std::size_t damaged = 0;
  std::map<std::uint16_t, std::string> types{};
  std::map<std::uint16_t, Channel> channels{};

  // Takes a record at a place, of which `is_cut` says that the file ends in it.
  void take(Kind kind, Bytes record, const Place& place, bool is_cut) {
    try {
      if (kind == Kind::chunk && place.chunk == 0) return take_chunk(record, place.offset, is_cut);
      ByteCursor cursor(record);
      if (is_cut || (kind != Kind::schema && kind != Kind::channel && kind != Kind::message))
        return;
      const auto id = cursor.number<std::uint16_t>();
      if (kind == Kind::schema) types[id] = cursor.text();
      if (kind == Kind::channel) take_channel(id, cursor);
      if (kind == Kind::message) take_message(id, cursor, place);
    } catch (const Error& fault) {
      if (fault.kind() != ErrorKind::refused || !fault.hint().empty()) throw;
      ++damaged;
    }
  }

  void take_channel(std::uint16_t id, ByteCursor& cursor) {
    const std::string& type = types[cursor.number<std::uint16_t>()];
    const std::string topic = cursor.text();
    see_channel(channels[id] = {topic, type, cursor.text()});
  }

  void take_message(std::uint16_t id, ByteCursor& cursor, Place place) {
    cursor.take(4);  // counts the messages of the channel
    const auto time = cursor.number<std::int64_t>();
    cursor.take(8);  // when it was published
    place.offset += cursor.at();
    place.size = cursor.left();
    const auto channel = channels.find(id);
    if (channel == channels.end()) refuse("a message of no channel");
    see_message({channel->second, time, cursor.take(place.size), place});
  }

  void take_chunk(Bytes record, std::uint64_t at, bool is_cut) {
    const Chunk opened = open_chunk(record);
    if (!opened.is_sound && !is_cut) refuse("a chunk is damaged");
    ByteCursor cursor(opened.records);
    while (cursor.left() >= kHeader) {
      const auto kind = static_cast<Kind>(cursor.number<std::uint8_t>());
      const auto length = cursor.number<std::uint64_t>();
      if (is_cut && length > cursor.left()) return;
      const Place place{at, cursor.at(), 0};
      take(kind, cursor.take(length), place, false);
    }
  }
};

}  // namespace

File::File(std::string path) : path_(std::move(path)) {
  std::error_code fault;
  size_ = fs::file_size(path_, fault);
  if (fault || size_ < kMagic.size()) refuse("cannot read " + path_ + ": " + fault.message());
}

Remarks File::scan(const std::function<void(const Channel&)>& see_channel,
                   const std::function<void(const Message&)>& see_message) const {
  std::ifstream input(path_, std::ios::binary);
  Scan scan{see_channel, see_message};
  bool has_end = false, has_index = false;
  std::uint64_t at = kMagic.size();
  while (size_ - at >= kHeader) {
    const std::vector<std::byte> header = read_part(input, at, kHeader);
    const auto kind = static_cast<Kind>(header[0]);
    const auto length = ByteCursor(Bytes(header).subspan(1)).number<std::uint64_t>();
    const std::uint64_t body = at + kHeader, there = std::min(length, size_ - body);
    has_end = has_end || kind == Kind::data_end;
    has_index = has_index || kind == Kind::chunk_index;
    if (kind == Kind::footer || kind == Kind::invalid) break;
    if (kind >= Kind::schema && kind <= Kind::chunk && there <= kMostRecord)
      scan.take(kind, read_part(input, body, there), {0, kind == Kind::chunk ? at : body, 0},
                there < length);
    if (there < length) break;
    at = body + length;
  }
  Remarks remarks;
  if (scan.damaged > 0)
    remarks.push_back({true,
                       "chunks or records that are damaged, and left out with all that they "
                       "hold: " +
                           std::to_string(scan.damaged)});
  if (!has_end)
    remarks.push_back({true,
                       "it has no end, as where its recorder was stopped: it is read as far as "
                       "it goes, " +
                           std::to_string(at) + " of " + std::to_string(size_) + " bytes"});
  else if (!has_index)
    remarks.push_back({false, "it has no index, and is read from its start"});
  return remarks;
}

std::vector<std::byte> File::read(const Place& place) const {
  std::ifstream input(path_, std::ios::binary);
  if (place.chunk == 0) return read_part(input, place.offset, place.size);
  const std::lock_guard lock(mutex_);
  if (kept_chunk_ != place.chunk) {
    kept_chunk_ = 0;
    const std::vector<std::byte> header = read_part(input, place.chunk, kHeader);
    const auto length = ByteCursor(Bytes(header).subspan(1)).number<std::uint64_t>();
    const std::uint64_t body = place.chunk + kHeader;
    kept_records_ =
        open_chunk(read_part(input, body, std::min({length, size_ - body, kMostRecord}))).records;
    kept_chunk_ = place.chunk;
  }
  const Bytes records(kept_records_);
  if (place.offset + place.size > records.size()) refuse("it has changed", path_, "copy it again");
  const Bytes bytes = records.subspan(place.offset, place.size);
  return {bytes.begin(), bytes.end()};
}

std::vector<std::string> files_of(const std::string& path) {
  std::error_code fault;
  std::vector<std::string> files;
  if (fs::is_regular_file(path, fault)) {
    std::string start(kMagic.size(), ' ');
    std::ifstream(path, std::ios::binary).read(start.data(), std::ssize(start));
    if (start == kMagic) files.push_back(path);
    return files;
  }
  for (fs::directory_iterator entry(path, fault), end; !fault && entry != end;
       entry.increment(fault))
    if (entry->path().extension() == ".mcap") files.push_back(entry->path().string());
  std::ranges::sort(files);
  return files;
}

}  // namespace vpm::mcap
