// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Are two results of any question the same, numbers by their bits?

#include <clearance/query/serialise.hpp>
#include <clearance/questions/certain_distance.hpp>
#include <clearance/questions/min_distance_supported.hpp>

namespace testing {

/// Counts by drop_reason. A reason that is newer than the kept digests is no number while it dropped nothing.
struct counts_by_reason {
  const std::uint64_t (&dropped)[clearance::drop_reasons];
};

/// Calls `f` with all members of a result. Those of more than eight, and of derived ones, are named here.
template <class T, class F>
void with_members(const T& a, const F& f) {
  if constexpr (std::is_same_v<T, clearance::min_distance_result>)
    f(a.state, a.distance, a.lower, a.upper, a.cloud, a.point, a.part, a.primitive, a.at, a.nearest, a.normal, a.seen,
      a.valid, counts_by_reason{a.dropped});
  else if constexpr (std::is_same_v<T, clearance::supported_distance>)
    f(a.state, a.distance, a.lower, a.cloud, a.point, a.part, a.primitive, a.isolated, a.nearest_isolated, a.counts);
  else if constexpr (std::is_same_v<T, clearance::certain_pair>)
    f(static_cast<const clearance::part_witness&>(a), a.lower, a.shares, a.to_ball);
  else if constexpr (requires { a.out_of_view; })  // unseen_part
    f(static_cast<const clearance::part_witness&>(a), a.lower, a.out_of_view, a.to_edge);
  // What clouds with gaps add is left out if it is 0: digests are of before there were such clouds.
  else if constexpr (std::is_same_v<T, clearance::frames::float_error>)
    a.gap == 0 ? f(a.here, a.per_metre) : f(a.here, a.per_metre, a.gap);
  else if constexpr (std::is_same_v<T, clearance::uncertainty_shares>)
    a.balls == 0 ? f(a.noise, a.calibration, a.time, a.joints, a.delay, a.gap, a.rounding)
                 : f(a.noise, a.calibration, a.time, a.joints, a.delay, a.gap, a.balls, a.rounding);
  else if constexpr (std::is_same_v<T, clearance::point_counts>)
    f(a.seen, a.valid, counts_by_reason{a.dropped});
  else
    std::apply(f, clearance::detail::members_of(a));
}

/// Calls `f` with every number, flag and state in a result, in order; a list is its length, then what it holds. So
/// padding is left out.
template <class T, class F>
void for_each_number(const T& a, const F& f) {
  if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>) {
    f(a);
  } else if constexpr (std::is_same_v<T, counts_by_reason>) {
    for (int k = 0; k < clearance::drop_reasons; ++k)
      if (k <= int(clearance::drop_reason::too_close) || a.dropped[k] != 0) f(a.dropped[k]);
  } else if constexpr (std::is_array_v<T>) {
    for (const auto& x : a) for_each_number(x, f);
  } else if constexpr (requires { a.begin(), a.size(); }) {
    f(a.size());
    for (const auto& x : a) for_each_number(x, f);
  } else {
    with_members(a, [&f](const auto&... members) { (for_each_number(members, f), ...); });
  }
}

/// All bits of a result.
template <class T>
std::vector<std::byte> bits_of(const T& a) {
  std::vector<std::byte> bits;
  for_each_number(a, [&](const auto& number) { clearance::detail::pack(bits, number); });
  return bits;
}

/// Have two results the same bits? Lists may be of two kinds.
template <class T, class U>
bool same_answer(const T& a, const U& b) {
  if constexpr (!std::is_same_v<T, U>) static_assert(std::is_same_v<typename T::value_type, typename U::value_type>);
  return bits_of(a) == bits_of(b);
}

}  // namespace testing
