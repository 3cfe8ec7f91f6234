// Finds the word that somebody meant.
#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace vpm::file {

// Returns how many letters must be changed, added or left out to make one word of the other.
std::size_t edits_between(const std::string& a, const std::string& b);

// Returns the word that is nearly the one given, at most two letters changed, added or left out, or
// that begins as it does; the first of the nearest, and empty if none is near. Words of `shortest`
// letters and more are looked for.
std::string nearest_word(const std::string& given, std::span<const std::string> words,
                         std::size_t shortest = 3);

// Returns "is 'bracket' meant?" of the nearest word; empty if none is near.
std::string guess_of_word(const std::string& given, std::span<const std::string> words);

}  // namespace vpm::file
