#include "libvpm/file/nearest_word.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace vpm::file {

std::size_t edits_between(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t k = 0; k <= b.size(); ++k) row[k] = k;
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i + 1);
    for (std::size_t k = 0; k < b.size(); ++k) {
      const std::size_t changed = diagonal + (a[i] == b[k] ? 0 : 1);
      diagonal = std::exchange(row[k + 1], std::min({changed, row[k + 1] + 1, row[k] + 1}));
    }
  }
  return row[b.size()];
}

std::string nearest_word(const std::string& given, std::span<const std::string> words,
                         std::size_t shortest) {
  constexpr std::size_t kMostEdits = 2, kLongest = 200;  // of a word that is compared
  if (given.size() < shortest || given.size() > kLongest) return {};
  std::string best;
  std::size_t fewest = kMostEdits + 1;
  for (const std::string& word : words) {
    if (word.size() > kLongest) continue;
    const std::size_t edits = word.starts_with(given) ? 0 : edits_between(given, word);
    if (edits < fewest) best = word, fewest = edits;
  }
  return best;
}

std::string guess_of_word(const std::string& given, std::span<const std::string> words) {
  const std::string best = nearest_word(given, words);
  return best.empty() ? "" : "is '" + best + "' meant?";
}

}  // namespace vpm::file
