// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Values per part for an answer: a few travel inside it, more lie in memory.

#include <clearance/concepts.hpp>

#include <algorithm>
#include <tuple>
#include <vector>

namespace clearance::backends {

/// A view of values. Up to `Few` values lie in the view itself, so that nothing has to be copied before a kernel
/// starts.
template <class T, std::uint32_t Few>
struct few_values {
  T here[Few] = {};
  const T* there = nullptr;  ///< All of them, or null.

  CLEARANCE_HD T operator[](std::uint32_t i) const { return there == nullptr ? here[i] : there[i]; }
};

/// A view of at most `Few` values, or of a copy in the next room of a question's `memory`.
template <std::uint32_t Few, class T, class Memory>
few_values<T, Few> few_or_kept(const std::vector<T>& values, Memory& memory) {
  few_values<T, Few> view;
  if (values.size() <= Few)
    std::copy(values.begin(), values.end(), view.here);
  else
    view.there = std::get<0>(memory.put(values));
  return view;
}

}  // namespace clearance::backends
