// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What an answer is told of each part: a few values go with it, more are in memory.

#include <clearance/concepts.hpp>

#include <algorithm>
#include <optional>
#include <vector>

namespace clearance::pairwise {

/// A view of values: the first `Few` in itself, if there are no more, so that nothing has to be copied before a kernel starts.
template <class T, std::uint32_t Few>
struct few_values {
  T here[Few] = {};
  const T* there = nullptr;  ///< All of them, or null.

  CLEARANCE_HD T operator[](std::uint32_t i) const { return there == nullptr ? here[i] : there[i]; }
};

/// Their memory, for one call.
template <backend On, class T, std::uint32_t Few>
class held_values {
 public:
  held_values(const On& on, const std::vector<T>& values) {
    if (values.size() <= Few) {
      std::copy(values.begin(), values.end(), view_.here);
    } else {
      many_.emplace(on.template make_scratch<T>(values.size()));
      on.stage(std::span<const T>(values), many_->data());
      view_.there = many_->data();
    }
  }
  const few_values<T, Few>& view() const { return view_; }

 private:
  few_values<T, Few> view_;
  std::optional<typename On::template scratch<T>> many_;
};

}  // namespace clearance::pairwise
