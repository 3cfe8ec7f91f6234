// Finds the word that somebody meant.
#pragma once

#include <span>
#include <string>

namespace vpm::tools {

// Returns the word that is nearly the one given, at most two letters changed, added or left out, or
// that begins as it does; the first of the nearest, and empty if none is near. Words of `shortest`
// letters and more are looked for.
std::string nearest_word(const std::string& given, std::span<const std::string> words,
                         std::size_t shortest = 3);

// Returns "is 'bracket' meant?" of the nearest word; empty if none is near.
std::string guess_of_word(const std::string& given, std::span<const std::string> words);

}  // namespace vpm::tools
