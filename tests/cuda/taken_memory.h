// Takes a device's memory, as other programs may.
#pragma once

#include <cstddef>

namespace vpm::testing {

// Takes memory of the current device until about `left` bytes are free.
class TakenMemory {
 public:
  explicit TakenMemory(std::size_t left);
  ~TakenMemory();
  TakenMemory(const TakenMemory&) = delete;
  TakenMemory& operator=(const TakenMemory&) = delete;

 private:
  void* taken_ = nullptr;
};

// Returns how many of the wanted teams find room if each takes this part of the free memory.
unsigned teams_made(unsigned wanted, double part_of_free);

}  // namespace vpm::testing
