// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Points within a distance by definition, how a result differs from it, and what the laws ask.

#include "support/brute_distances.hpp"
#include "support/frames.hpp"

#include <clearance/questions/within.hpp>

namespace testing {

template <class P>
clearance::within_result brute_within(const scene<P>& s, const clouds& all, const std::vector<real>& radius) {
  clearance::within_result r;
  r.offsets.assign(s.parts.size() + 1, 0);
  for_each_pair(s, all, [&](const clearance::pair_distance& pair) {
    if (!(pair.distance <= radius[pair.part])) return;
    r.pairs.push_back(pair);
    for (std::size_t k = pair.part + 1; k < r.offsets.size(); ++k) ++r.offsets[k];
  });
  std::ranges::stable_sort(r.pairs, {},
                           [](const clearance::pair_distance& p) { return std::pair(p.part, p.distance); });
  return r;
}

inline void require_same(const clearance::within_result& found, const clearance::within_result& expected, verdict& v,
                         const std::string& what) {
  v.require(found.offsets == expected.offsets, what, ": ", found.pairs.size(), " pairs and not ",
            expected.pairs.size());
  const bool same = std::ranges::equal(found.pairs, expected.pairs,
                                       [](const clearance::pair_distance& a, const clearance::pair_distance& b) {
                                         return a.cloud == b.cloud && a.point == b.point && a.part == b.part &&
                                                a.primitive == b.primitive && same_bits(a.distance, b.distance);
                                       });
  v.require(same, what, ": some pair differs");
}

/// The same for a list in any order that claims `count` pairs.
inline void require_listed(std::vector<clearance::pair_distance> pairs, unsigned long long count,
                           clearance::within_result expected, verdict& v, const std::string& what) {
  v.require(count == expected.pairs.size() && pairs.size() == count, what, ": ", count, " pairs and not ",
            expected.pairs.size());
  for (auto* list : {&pairs, &expected.pairs})
    std::ranges::sort(*list, {},
                      [](const clearance::pair_distance& p) { return std::tuple(p.part, p.cloud, p.point); });
  clearance::within_result found = expected;
  found.pairs = std::move(pairs);
  require_same(found, expected, v, what);
}

/// Two balls among 50,000 points: more pairs than a list has room for at first.
inline scene<inner_sphere> two_balls() {
  dice d(99);
  scene<inner_sphere> s;
  for (int part = 0; part < 2; ++part)
    s.parts.push_back({{{0.1f * float(part), 0, 0}, 0.1f}}), s.poses.push_back(Eigen::Isometry3d::Identity());
  s.points = d.points(50000, 1);
  return s;
}

/// For the laws of all questions.
struct within_cases {
  using question = clearance::within;
  std::size_t found = 0, longest = 0;

  template <class P>
  static std::vector<question> of_scene(const scene<P>& s) {
    std::vector<question> all;
    for (const real radius : {real(-0.02), real(0), real(0.1), clearance::infinity}) {
      std::vector<double> own(s.parts.size(), radius * real(s.size));
      all.push_back({{own[0]}});
      own[0] *= 2;
      all.push_back({own});
    }
    return all;
  }
  template <class P>
  static clearance::within_result by_definition(const scene<P>& s, const clouds& all, const question& q) {
    std::vector<real> radius(s.parts.size(), real(q.radius[0]));
    if (q.radius.size() > 1) radius.assign(q.radius.begin(), q.radius.end());
    return brute_within(s, all, radius);
  }
  /// That of frame 4 is a longer list than there is room for at first.
  static question of_frame(std::size_t number, std::size_t parts) {
    return {std::vector<double>(number % 2 == 1 ? parts : 1, number != 4 ? 0.3f : parts < 100 ? 10 : 0.8f)};
  }
  static std::vector<question> refused() { return {{{clearance::not_a_number}}, {{1, 1, 1, 1}}}; }
  void saw(const clearance::within_result& r) { found += r.pairs.size(), longest = std::max(longest, r.pairs.size()); }

  template <class On>
  struct written {
    const On& on;
    typename On::template buffer<clearance::pair_distance> pairs;
    typename On::template buffer<unsigned long long> count;
    typename On::template buffer<clearance::point_counts> counts;

    written(const On& on, std::size_t parts, std::size_t points)
        : on(on),
          pairs(room_on<clearance::pair_distance>(on, parts * points)),
          count(room_on(on, 1, 77ull)),
          counts(room_on<clearance::point_counts>(on, 1)) {}
    question::out out() { return {pairs.data(), pairs.size(), count.data(), counts.data()}; }
    void require(const clearance::within_result& expected, verdict& v, const std::string& what) const {
      const auto n = on.copy_out(count)[0];
      require_listed(on.copy_out(pairs.data(), std::min<std::size_t>(n, pairs.size())), n, expected, v, what);
      v.require(on.copy_out(counts)[0].valid == expected.counts.valid, what, ": counts");
    }
  };
};

}  // namespace testing
