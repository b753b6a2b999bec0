// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The first point within a margin by definition, how a result differs from it, and what the laws ask.

#include "support/brute_distances.hpp"
#include "support/frames.hpp"

#include <clearance/questions/in_collision.hpp>

namespace testing {

/// The first pair (point, part) that is certainly within its margin, and the first that may be.
template <class P>
clearance::collision_result brute_collision(const scene<P>& s, const clouds& all, const std::vector<double>& margins) {
  const auto error = error_of(s, all);
  clearance::collision_result r;
  for (const auto& cloud : all)
    for (std::size_t i = 0; i < cloud.source.size(); ++i) r.counts.valid += cloud.source[i].valid();
  if (r.counts.valid != 0) r.state = clearance::state::free;
  for_each_pair(s, all, [&](const clearance::pair_distance& pair) {
    const long double d = pair.distance, off = error.here + (long double)(error.per_metre) * std::abs(d);
    const clearance::state its = d + off <= margins[pair.part]   ? clearance::state::collision
                                 : d - off <= margins[pair.part] ? clearance::state::possible
                                                                 : clearance::state::free;
    if (its == clearance::state::free || r.state == clearance::state::collision || its == r.state) return;
    r.state = its, r.cloud = pair.cloud, r.point = pair.point, r.part = pair.part;
  });
  return r;
}

inline void require_same(const clearance::collision_result& found, const clearance::collision_result& expected,
                         verdict& v, const std::string& what) {
  v.require(found.state == expected.state && found.cloud == expected.cloud && found.point == expected.point &&
                found.part == expected.part && found.counts.valid == expected.counts.valid,
            what, ": ", to_string(found.state), " and not ", to_string(expected.state), ", point ", found.point,
            " and not ", expected.point, ", part ", found.part, " and not ", expected.part);
}

/// For the laws of all questions.
struct collision_cases {
  using question = clearance::in_collision;
  std::size_t states[4] = {};

  template <class P>
  static std::vector<question> of_scene(const scene<P>& s) {
    std::vector<question> all;
    for (const double margin : {-0.1, 0.0, 1e-7, 0.02, 0.3}) {
      std::vector<double> own(s.parts.size(), margin * s.size);
      all.push_back({{own[0]}});
      own[0] *= 2;
      all.push_back({own});
    }
    return all;
  }
  template <class P>
  static clearance::collision_result by_definition(const scene<P>& s, const clouds& all, const question& q) {
    return brute_collision(s, all, q.margins.size() > 1 ? q.margins : std::vector(s.parts.size(), q.margins[0]));
  }
  static question of_frame(std::size_t number, std::size_t parts) {
    return {std::vector<double>(number % 2 == 1 ? parts : 1, number < 4 ? 0.01 : -0.05)};
  }
  static std::vector<question> refused() { return {{{clearance::not_a_number}}, {{0.1, 0.2}}}; }
  void saw(const clearance::collision_result& r) { ++states[int(r.state)]; }
  std::size_t count(clearance::state its) const { return states[int(its)]; }

  template <class On>
  struct written {
    const On& on;
    typename On::template buffer<clearance::collision_result> result;

    written(const On& on, std::size_t, std::size_t) : on(on), result(room_on<clearance::collision_result>(on, 1)) {}
    question::out out() { return result.data(); }
    void require(const clearance::collision_result& expected, verdict& v, const std::string& what) const {
      require_same(on.copy_out(result)[0], expected, v, what);
    }
  };
};

}  // namespace testing
