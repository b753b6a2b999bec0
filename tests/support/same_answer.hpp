// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Are two results of any question the same, numbers by their bits?

#include "support/same_result.hpp"

#include <clearance/query/fields.hpp>

namespace testing {

template <class T>
bool same_answer(const T& a, const T& b) {
  if constexpr (std::is_same_v<T, clearance::min_distance_result>) {
    return same_result(a, b);
  } else if constexpr (requires { a.nearest_isolated; }) {  // a supported_distance
    return a.state == b.state && same_bits(a.distance, b.distance) && same_bits(a.lower, b.lower) &&
           a.cloud == b.cloud && a.point == b.point && a.part == b.part && a.primitive == b.primitive &&
           a.isolated == b.isolated && same_answer(a.nearest_isolated, b.nearest_isolated) &&
           same_answer(a.counts, b.counts);
  } else if constexpr (std::is_same_v<T, clearance::part_witness>) {
    return same_witness(a, b);
  } else if constexpr (std::is_floating_point_v<T>) {
    return same_bytes(a, b);
  } else if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>) {
    return a == b;
  } else if constexpr (std::is_same_v<T, clearance::point_counts>) {
    return a.seen == b.seen && a.valid == b.valid &&
           std::equal(a.dropped, a.dropped + clearance::drop_reasons, b.dropped);
  } else if constexpr (requires { a.begin(), a.size(); }) {
    return a.size() == b.size() &&
           std::equal(a.begin(), a.end(), b.begin(), [](const auto& x, const auto& y) { return same_answer(x, y); });
  } else {
    const auto mine = clearance::detail::members_of(a), others = clearance::detail::members_of(b);
    return [&]<std::size_t... I>(std::index_sequence<I...>) {
      return (same_answer(std::get<I>(mine), std::get<I>(others)) && ...);
    }(std::make_index_sequence<std::tuple_size_v<decltype(mine)>>());
  }
}

}  // namespace testing
