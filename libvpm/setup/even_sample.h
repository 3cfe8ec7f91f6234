// Keeps some of many items, evenly spread over them.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

namespace vpm {

// Keeps every stride-th of the items that are added, and doubles the stride when there are many.
template <class Item>
class EvenSample {
 public:
  void add(const Item& item) {
    if (seen_++ % stride_ != 0) return;
    kept_.push_back(item);
    if (kept_.size() < kMostKept) return;
    for (std::size_t i = 0; 2 * i < kept_.size(); ++i) kept_[i] = std::move(kept_[2 * i]);
    kept_.resize(kept_.size() / 2);
    stride_ *= 2;
  }

  const std::vector<Item>& kept() const { return kept_; }
  std::size_t stride() const { return stride_; }

 private:
  static constexpr std::size_t kMostKept = 512;

  std::vector<Item> kept_;
  std::size_t seen_ = 0, stride_ = 1;
};

}  // namespace vpm
