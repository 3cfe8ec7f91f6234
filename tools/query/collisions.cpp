#include "tools/query/collisions.h"

#include <cstdio>

namespace vpm::tools {

namespace {

constexpr std::size_t kMostNamed = 20;

// Returns the sentence of a line whose volume is above the limit, m^3.
std::string named(const nlohmann::ordered_json& line, double limit) {
  std::string name = "pose " + line["pose"].dump();
  if (line.contains("id")) name += " (" + line["id"].dump() + ")";
  if (line.contains("tool")) name += ", tool " + line["tool"].dump();
  char text[80];
  std::snprintf(text, sizeof text, ": %.6g m³, above %.6g", line["volume"].get<double>(), limit);
  return name + text;
}

}  // namespace

const char* text_of(Collides found) {
  return found == Collides::yes ? "yes" : found == Collides::no ? "no" : "unknown";
}

std::string Collisions::show(const Result& result, nlohmann::ordered_json& line) const {
  if (is_asked_) line["collides"] = text_of(collides(result, unseen_limit_));
  if (!fail_above_) return "";
  const bool is_above = result.volume > *fail_above_;
  line["above"] = is_above;
  return is_above ? named(line, *fail_above_) : "";
}

void Collisions::count(const Result& result, const std::string& above) {
  if (is_asked_) count(collides(result, unseen_limit_));
  if (!above.empty() && count_above_++ < kMostNamed) above_.push_back(above);
}

void Collisions::count(Collides found) {
  any_hit_ = any_hit_ || found == Collides::yes;
  any_unknown_ = any_unknown_ || found == Collides::unknown;
}

std::vector<std::string> Collisions::above() const {
  std::vector<std::string> said = above_;
  if (count_above_ > kMostNamed)
    said.push_back(std::to_string(count_above_ - kMostNamed) + " more poses are above");
  return said;
}

int Collisions::exit_code() const {
  constexpr int kHit = 10, kUnknown = 11;
  return any_hit_ || count_above_ > 0 ? kHit : any_unknown_ ? kUnknown : 0;
}

}  // namespace vpm::tools
