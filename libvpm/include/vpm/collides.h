// Says if a tool is in a scene's solid, or that nobody can know.
#pragma once

#include <vpm/query_types.h>

#include <cstdint>

namespace vpm {

// unknown: nothing of the tool is in the solid as far as anybody knows, but too much of it was not
// seen.
enum class Collides : std::uint8_t { no, yes, unknown };

// Part of the tool that may be unseen or out of view where collides() answers no.
inline constexpr double kUnseenLimit = 0.02;

// Returns yes if a volume of the tool is in the solid; otherwise unknown, if the part of it that is
// unseen or out of view (Visibility) is more than `unseen_limit`, or the result does not tell what
// was seen; otherwise no. Thread-safe.
constexpr Collides collides(const Result& result, double unseen_limit = kUnseenLimit) {
  if (result.volume > 0) return Collides::yes;
  if (!result.visibility) return Collides::unknown;
  const double not_seen = result.visibility->unseen + result.visibility->out_of_view;
  return not_seen > unseen_limit ? Collides::unknown : Collides::no;
}

}  // namespace vpm
