// Answers --collides, --collides-only and --fail-above: a field for each line of results, and the
// exit code of all.
#pragma once

#include <vpm/query_types.h>

#include <cstddef>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace vpm::tools {

// Returns the value of the field.
const char* text_of(Collides found);

class Collisions {
 public:
  // Tells collisions if they are asked, and volumes above `fail_above`, m^3, if that is given.
  // `unseen_limit` is that of collides().
  Collisions(bool is_asked, double unseen_limit, std::optional<double> fail_above)
      : is_asked_(is_asked), unseen_limit_(unseen_limit), fail_above_(fail_above) {}

  // Adds the fields `collides` and `above`, if they are asked, to the line of results of one pose,
  // and takes it into account.
  void answer(const Result& result, nlohmann::ordered_json& line) {
    count(result, show(result, line));
  }

  // The two parts of answer(). The first one may be called by many threads at once, and returns a
  // sentence for a line above the limit, "" for others; the second takes it.
  std::string show(const Result& result, nlohmann::ordered_json& line) const;
  void count(const Result& result, const std::string& above);
  // Takes an answer into account for exit_code(), of a pose whose line says `collides` already.
  void count(Collides found);

  double unseen_limit() const { return unseen_limit_; }
  // Returns a sentence for each line above the limit, and for all further ones after twenty.
  std::vector<std::string> above() const;

  // Returns 10 if any line was a hit or above the limit, else 11 if any was unknown, else 0; 0 if
  // nobody asked.
  int exit_code() const;

 private:
  bool is_asked_;
  double unseen_limit_;
  std::optional<double> fail_above_;
  std::vector<std::string> above_;  // the first of them
  std::size_t count_above_ = 0;
  bool any_hit_ = false, any_unknown_ = false;
};

}  // namespace vpm::tools
