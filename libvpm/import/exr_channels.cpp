#include "libvpm/import/exr_channels.h"

#include <algorithm>
#include <initializer_list>
#include <optional>

#include "libvpm/core/error.h"
#include "libvpm/file/text.h"

namespace vpm {
namespace {

using Indices = std::vector<std::size_t>;

// Name of a channel in lower case, as "layer.last".
struct Words {
  std::string layer;  // with the part in front; may be empty
  std::string last;
};

Words words_of(const ExrChannelName& channel) {
  const std::string name = file::in_lower_case(channel.name);
  const std::size_t dot = name.rfind('.');
  const std::string part = file::in_lower_case(channel.part);
  if (dot == name.npos) return {part, name};
  return {part.empty() ? name.substr(0, dot) : part + "." + name.substr(0, dot),
          name.substr(dot + 1)};
}

bool has(const std::string& text, const char* word) {
  return text.find(word) != text.npos;
}

bool is_one_of(const std::string& word, std::initializer_list<const char*> words) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

// Returns the channel of the same layer that is called `last`.
std::optional<std::size_t> sibling(const std::vector<Words>& all, const std::string& layer,
                                   const char* last) {
  for (std::size_t i = 0; i < all.size(); ++i)
    if (all[i].layer == layer && all[i].last == last) return i;
  return std::nullopt;
}

bool is_of_vector(const Words& words, const std::vector<Words>& all) {
  return sibling(all, words.layer, "x") && sibling(all, words.layer, "y");
}

// True if the name says depth. A Z beside X and Y is part of a vector, and mist is a fraction.
bool says_depth(const Words& words, const std::vector<Words>& all) {
  if (has(words.layer, "mist") || has(words.last, "mist")) return false;
  const bool is_vector = is_of_vector(words, all);
  if (is_one_of(words.last, {"z", "depth", "zdepth"})) return !is_vector;
  const bool is_red = words.last == "r" && has(words.layer, "depth");
  return is_red || (has(words.layer, "depth") && is_one_of(words.last, {"v", "y"}) && !is_vector);
}

// Returns the channel alone, or R, G and B of its layer if it is the R of these.
Indices with_siblings(std::size_t channel, const std::vector<Words>& all) {
  if (all[channel].last != "r") return {channel};
  const auto green = sibling(all, all[channel].layer, "g"),
             blue = sibling(all, all[channel].layer, "b");
  return green && blue ? Indices{channel, *green, *blue} : Indices{channel};
}

// Returns R, G and B, if the file has no channels but these and A.
Indices grey_picture(const std::vector<Words>& all) {
  const auto red =
      std::find_if(all.begin(), all.end(), [](const Words& words) { return words.last == "r"; });
  if (red == all.end()) return {};
  const bool is_picture = std::all_of(all.begin(), all.end(), [&](const Words& words) {
    return words.layer == red->layer && is_one_of(words.last, {"r", "g", "b", "a"});
  });
  const Indices found = with_siblings(static_cast<std::size_t>(red - all.begin()), all);
  return is_picture && found.size() == 3 ? found : Indices{};
}

std::string names_of(const std::vector<ExrChannelName>& channels, const Indices& which) {
  std::vector<std::string> names;
  for (const std::size_t k : which) names.push_back(full_name(channels[k]));
  return file::listed(names);
}

std::string names_of(const std::vector<ExrChannelName>& channels) {
  Indices all(channels.size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
  return names_of(channels, all);
}

std::vector<Words> words_of(const std::vector<ExrChannelName>& channels) {
  std::vector<Words> words;
  for (const ExrChannelName& channel : channels) words.push_back(words_of(channel));
  return words;
}

[[noreturn]] void refuse_all(const std::vector<ExrChannelName>& channels,
                             const std::vector<Words>& words, const std::string& name) {
  std::string defect = "no channel's name says depth (Z, depth.Z)";
  for (std::size_t i = 0; i < words.size(); ++i)
    if (words[i].last == "z" && is_of_vector(words[i], words))
      defect = "no channel is surely depth: " + file::shown(full_name(channels[i])) +
               " stands beside X and Y, as in a position or a normal";
  refuse(defect + "; it has " + names_of(channels), name,
         "name the one that is depth with `channel`, if there is one");
}

Indices channel_asked_for(const std::vector<ExrChannelName>& channels, const std::string& asked,
                          const std::string& name) {
  Indices found;
  for (std::size_t i = 0; i < channels.size(); ++i)
    if (channels[i].name == asked || full_name(channels[i]) == asked) found.push_back(i);
  if (found.empty())
    refuse("there is no channel '" + file::shown(asked) + "'; it has " + names_of(channels), name,
           "name one of these with `channel`");
  if (found.size() > 1)
    refuse(
        "several parts have a channel '" + file::shown(asked) + "': " + names_of(channels, found),
        name, "name one of these with `channel`");
  return found;
}

}  // namespace

std::string full_name(const ExrChannelName& channel) {
  return channel.part.empty() ? channel.name : channel.part + ":" + channel.name;
}

std::vector<std::size_t> depth_channels(const std::vector<ExrChannelName>& channels,
                                        const std::string& asked, const std::string& name) {
  if (!asked.empty()) return channel_asked_for(channels, asked, name);
  const std::vector<Words> words = words_of(channels);
  Indices found;
  for (std::size_t i = 0; i < words.size(); ++i)
    if (says_depth(words[i], words)) found.push_back(i);
  if (found.size() > 1)
    refuse("several channels may be its depth: " + names_of(channels, found), name,
           "name one of these with `channel`");
  if (found.size() == 1) return with_siblings(found.front(), words);
  if (words.size() == 1 && is_one_of(words.front().last, {"y", "v", "r"})) return {0};
  found = grey_picture(words);
  if (found.empty()) refuse_all(channels, words, name);
  return found;
}

std::string words_of_choice(const std::vector<ExrChannelName>& channels,
                            const std::vector<std::size_t>& chosen) {
  if (chosen.size() == 1)
    return channels.size() == 1 ? "" : "depth is its channel " + names_of(channels, chosen);
  const std::vector<Words> words = words_of(channels);
  return says_depth(words[chosen.front()], words)
             ? "depth is its channels " + names_of(channels, chosen) + ", which are equal"
             : "no channel's name says depth: R, G and B, which are equal, are taken for it";
}

void refuse_difference(const std::vector<ExrChannelName>& channels,
                       const std::vector<std::size_t>& chosen, const std::string& pixel,
                       const std::string& name) {
  const std::vector<Words> words = words_of(channels);
  if (!says_depth(words[chosen.front()], words))
    refuse("R, G and B differ at pixel " + pixel + ": a colour image, no depth", name);
  refuse("its channels " + names_of(channels, chosen) + " differ at pixel " + pixel +
             ", so one of them is depth at most",
         name,
         "name it with `channel`, such as " + file::shown(full_name(channels[chosen.front()])));
}

}  // namespace vpm
