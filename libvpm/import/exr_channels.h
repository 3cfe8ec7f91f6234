// Tells which channel of an OpenEXR file is depth, by the names that renderers and sensors give.
#pragma once

#include <string>
#include <vector>

namespace vpm {

struct ExrChannelName {
  std::string part;  // empty in files of one part that has no name
  std::string name;  // with its layers: "depth.Z"
};

// Returns "part:name", or "name" where the part has none.
std::string full_name(const ExrChannelName& channel);

// Returns the indices of the channels to read: one, or three, R, G and B, whose values must be
// equal everywhere.
//
// `asked` is the name that the user gives, with or without its part; if empty, it is in this order:
// the one channel whose name says depth ("Z", "depth.Z", "Depth.V", "ViewLayer.Depth.Z", a part
// "depth"); the file's only channel, if it is called Y, V or R; R, G and B beside nothing but A.
// Throws Error(refused), naming the channels, if there is none or several may be meant.
std::vector<std::size_t> depth_channels(const std::vector<ExrChannelName>& channels,
                                        const std::string& asked, const std::string& name);

// Returns the text of a note that names the channels chosen; empty if there were no others.
std::string words_of_choice(const std::vector<ExrChannelName>& channels,
                            const std::vector<std::size_t>& chosen);

// Throws Error(refused) that the values of the chosen channels are not equal at a pixel, "(3, 4)".
[[noreturn]] void refuse_difference(const std::vector<ExrChannelName>& channels,
                                    const std::vector<std::size_t>& chosen,
                                    const std::string& pixel, const std::string& name);

}  // namespace vpm
