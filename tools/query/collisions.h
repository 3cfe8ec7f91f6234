// Answers --collides: a field for each line of results, and the exit code of all.
#pragma once

#include <vpm/query_types.h>

#include <nlohmann/json.hpp>

namespace vpm::tools {

class Collisions {
 public:
  // Does nothing unless `is_asked`. `unseen_limit` is that of collides().
  Collisions(bool is_asked, double unseen_limit)
      : is_asked_(is_asked), unseen_limit_(unseen_limit) {}

  // Adds the field `collides` to the line of results of one pose.
  void answer(const Result& result, nlohmann::ordered_json& line);

  // Returns 10 if any line was a hit, else 11 if any was unknown, else 0; 0 if nobody asked.
  int exit_code() const;

 private:
  bool is_asked_;
  double unseen_limit_;
  bool any_hit_ = false, any_unknown_ = false;
};

}  // namespace vpm::tools
