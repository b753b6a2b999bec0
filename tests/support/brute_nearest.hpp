// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The k nearest points of each part by definition, how a result differs from it, and what the laws ask.

#include "support/brute_within.hpp"

#include <clearance/questions/nearest_k.hpp>

namespace testing {

template <class P>
clearance::nearest_k_result brute_nearest(const scene<P>& s, const clouds& all, std::size_t k, real d_max) {
  const auto near = brute_within(s, all, std::vector<real>(s.parts.size(), d_max));
  clearance::nearest_k_result r;
  r.per_part = k;
  for (std::uint32_t part = 0; part < s.parts.size(); ++part)
    for (std::size_t i = 0; i < k; ++i)
      r.pairs.push_back(near.offsets[part] + i < near.offsets[part + 1]
                            ? near.pairs[near.offsets[part] + i]
                            : clearance::pair_distance{~0u, ~0u, part, ~0u, clearance::infinity});
  return r;
}

inline void require_same(const clearance::nearest_k_result& found, const clearance::nearest_k_result& expected,
                         verdict& v, const std::string& what) {
  v.require(found.per_part == expected.per_part && found.pairs.size() == expected.pairs.size(), what, ": ",
            found.pairs.size(), " pairs");
  for (std::size_t i = 0; i < std::min(found.pairs.size(), expected.pairs.size()); ++i) {
    const clearance::pair_distance &a = found.pairs[i], &b = expected.pairs[i];
    v.require(a.cloud == b.cloud && a.point == b.point && a.part == b.part && a.primitive == b.primitive &&
                  same_bits(a.distance, b.distance),
              what, ", pair ", i, ": point ", a.point, " at ", a.distance, " and not ", b.point, " at ", b.distance);
  }
}

/// For the laws of all questions.
struct nearest_k_cases {
  using question = clearance::nearest_k;

  template <class P>
  static std::vector<question> of_scene(const scene<P>& s) {
    std::vector<question> all;
    for (const std::size_t k : {1, 7, 400})
      for (const real d_max : {real(-0.02), real(0.3), clearance::infinity}) all.push_back({k, d_max * real(s.size)});
    return all;
  }
  template <class P>
  static clearance::nearest_k_result by_definition(const scene<P>& s, const clouds& all, const question& q) {
    return brute_nearest(s, all, q.k, real(q.d_max));
  }
  /// What is known of a frame is of use in some, and in some not.
  static question of_frame(std::size_t number, std::size_t) { return {.k = number < 4 ? 500u : 3u}; }
  static std::vector<question> refused() { return {{.k = 0}}; }
  static void saw(const clearance::nearest_k_result&) {}
};

}  // namespace testing
