// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/backend/host.hpp>
#include <clearance/packing/compass.hpp>

namespace clearance {

/// What packing in rounds needs from a host besides a backend. The result does not depend on threads.
class host_steps {
 public:
  static constexpr std::size_t cells = 1u << 20;

  explicit host_steps(const host&) {}

  /// Takes only a few of the largest keys at once, so that little work is wasted. They are kept in a heap. Each call
  /// adds the new cells, and those chosen last time; after any other change call `forget`.
  std::size_t next(const double* keys, std::size_t n, std::size_t most, std::uint32_t* out, double& least) {
    const bool afresh = known_ == 0;
    const auto add = [&](std::uint32_t i) {
      if (!(keys[i] > 0)) return;
      turns_.push_back({keys[i], numbers_++, i});
      if (!afresh) std::push_heap(turns_.begin(), turns_.end());
    };
    for (const std::uint32_t i : chosen_) add(i);
    for (; known_ < n; ++known_) add(std::uint32_t(known_));
    if (afresh) std::make_heap(turns_.begin(), turns_.end());
    chosen_.clear();
    const double top = turns_.empty() ? 0 : turns_.front().key;
    least = 0.93 * top;  // a cell that lost little to a new sphere touches it: prefer it to places far from all
    while (!turns_.empty() && turns_.front().key >= 0.98 * top && chosen_.size() < std::min(most, batch)) {
      chosen_.push_back(turns_.front().cell);
      std::pop_heap(turns_.begin(), turns_.end());
      turns_.pop_back();
    }
    std::copy(chosen_.begin(), chosen_.end(), out);
    return chosen_.size();
  }
  void forget() { turns_.clear(), chosen_.clear(), known_ = numbers_ = 0; }

  template <class F>
  void each(std::size_t n, const F& f) const {
    tbb::parallel_for(std::size_t(0), n, f);
  }
  template <class F>
  void climbers(std::size_t n, const F& f) const {
    tbb::parallel_for(std::size_t(0), n, [&](std::size_t i) { f(i, one_lane{}); });
  }
  template <class F>
  std::size_t select(std::size_t n, const F& f, std::uint32_t* out) const {
    std::size_t count = 0;
    for (std::size_t i = 0; i < n; ++i) out[count] = std::uint32_t(i), count += f(i);
    return count;
  }
  template <class F>
  double largest(std::size_t n, const F& f) const {
    double most = 0;
    for (std::size_t i = 0; i < n; ++i) most = std::max(most, f(i));
    return most;
  }

 private:
  static constexpr std::size_t batch = 256;
  struct turn {
    double key;
    std::uint32_t number;  // of two equal keys the earlier one
    std::uint32_t cell;

    friend bool operator<(const turn& a, const turn& b) { return a.key != b.key ? a.key < b.key : a.number > b.number; }
  };

  std::vector<turn> turns_;            // a heap
  std::vector<std::uint32_t> chosen_;  // chosen last time; not in the heap
  std::size_t known_ = 0;
  std::uint32_t numbers_ = 0;
};

}  // namespace clearance
