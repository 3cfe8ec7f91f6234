// Headers and numbers of text-based formats, read from a file held in memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace vpm {

inline std::string_view as_text(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::vector<std::string_view> split_words(std::string_view line);

// The whole word as a number; "nan" and "inf" are numbers. Nothing otherwise.
std::optional<double> to_number(std::string_view word);
std::optional<std::uint64_t> to_count(std::string_view word);

// Goes through a file line by line or word by word.
class TextCursor {
 public:
  explicit TextCursor(std::string_view text) : text_(text) {}

  // The next line without its end ("\n" or "\r\n"). Nothing at the end of the file.
  std::optional<std::string_view> line();
  // The words of the next line that has any; none at the end of the file.
  std::vector<std::string_view> row();
  // The next word, over ends of lines. Empty at the end of the file.
  std::string_view word();

  std::size_t offset() const { return at_; }
  std::size_t remaining() const { return text_.size() - at_; }

 private:
  std::string_view text_;
  std::size_t at_ = 0;
};

// A binary number of a file: kind 'F' (float), 'I' (signed), 'U' (unsigned); size in bytes.
struct ScalarType {
  char kind = 0;
  std::uint8_t size = 0;  // 0: no such type
};
bool is_known(ScalarType type);
double read_scalar(const std::byte* from, ScalarType type, bool big_endian);

}  // namespace vpm
