// A device whose memory others have taken.
#pragma once

#include <cstddef>

namespace vpm::testing {

// Takes memory of the current device until about so much is left, in bytes.
class TakenMemory {
 public:
  explicit TakenMemory(std::size_t left);
  ~TakenMemory();
  TakenMemory(const TakenMemory&) = delete;
  TakenMemory& operator=(const TakenMemory&) = delete;

 private:
  void* taken_ = nullptr;
};

// How many teams find room, of which each takes this part of the memory that is free, if so many
// are wanted.
unsigned teams_made(unsigned wanted, double part_of_free);

}  // namespace vpm::testing
