#include "tools/query/collisions.h"

namespace vpm::tools {

void Collisions::answer(const Result& result, nlohmann::ordered_json& line) {
  if (!is_asked_) return;
  const Collides found = collides(result, unseen_limit_);
  any_hit_ = any_hit_ || found == Collides::yes;
  any_unknown_ = any_unknown_ || found == Collides::unknown;
  line["collides"] = found == Collides::yes ? "yes" : found == Collides::no ? "no" : "unknown";
}

int Collisions::exit_code() const {
  constexpr int kHit = 10, kUnknown = 11;
  return any_hit_ ? kHit : any_unknown_ ? kUnknown : 0;
}

}  // namespace vpm::tools
