// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The nearest point that others confirm, by definition, how a result differs from it, and what the laws ask.

#include "support/brute_pairs.hpp"
#include "support/product.hpp"

#include <clearance/questions/min_distance_supported.hpp>

#include <map>

namespace testing {

template <class P>
clearance::supported_distance brute_support(const scene<P>& s, const clouds& all,
                                            const clearance::min_distance_supported& options) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, clearance::pair_distance> nearest;  // by point
  for_each_pair(s, all, [&](const clearance::pair_distance& pair) {
    const auto [its, fresh] = nearest.try_emplace({pair.cloud, pair.point}, pair);
    if (!fresh && pair.distance < its->second.distance) its->second = pair;
  });
  struct candidate {
    clearance::pair_distance pair;
    clearance::position at;
  };
  std::vector<clearance::world_transform> poses;
  for (const auto& cloud : all) poses.emplace_back(clearance::rigid(cloud.pose));
  std::vector<candidate> order;
  for (const auto& [where, pair] : nearest)
    order.push_back({pair, poses[pair.cloud](all[pair.cloud].source[pair.point].position)});
  std::ranges::stable_sort(order, {}, [](const candidate& c) { return c.pair.distance; });
  clearance::supported_distance r;
  for (const auto& [pair, p] : order) {
    std::uint32_t around = 0;
    for (const auto& [other, q] : order) {
      const double x = q.x - p.x, y = q.y - p.y, z = q.z - p.z;
      around += std::fma(x, x, std::fma(y, y, z * z)) <= options.radius * options.radius;
    }
    if (around >= options.min_points) {
      r.distance = pair.distance, r.cloud = pair.cloud, r.point = pair.point, r.part = pair.part,
      r.primitive = pair.primitive;
      break;
    }
    if (r.isolated++ == 0) r.nearest_isolated = pair;
  }
  if (r.cloud == ~0u && !order.empty()) r.distance = clearance::infinity;
  return r;
}

inline void require_same(const clearance::supported_distance& found, const clearance::supported_distance& expected,
                         verdict& v, const std::string& what) {
  const auto &a = found.nearest_isolated, &b = expected.nearest_isolated;
  const bool nowhere = found.distance != found.distance && expected.distance != expected.distance;
  v.require((same_bits(found.distance, expected.distance) || nowhere) && found.cloud == expected.cloud &&
                found.point == expected.point && found.part == expected.part && found.primitive == expected.primitive,
            what, ": point ", found.point, " at ", found.distance, " is confirmed, and not ", expected.point, " at ",
            expected.distance);
  v.require(found.isolated == expected.isolated && same_bits(a.distance, b.distance) && a.cloud == b.cloud &&
                a.point == b.point && a.part == b.part && a.primitive == b.primitive,
            what, ": ", found.isolated, " are alone, and not ", expected.isolated);
}

/// For the laws of all questions.
struct supported_cases {
  using question = clearance::min_distance_supported;
  std::size_t isolated = 0, confirmed = 0;

  template <class P>
  static std::vector<question> of_scene(const scene<P>& s) {
    std::vector<question> all;
    for (const std::uint32_t min_points : {1, 2, 4})
      for (const double radius : {0.0, 0.05, 0.3})
        all.push_back({.min_points = min_points, .radius = radius * s.size, .most = 1 << 14});
    return all;
  }
  template <class P>
  static clearance::supported_distance by_definition(const scene<P>& s, const clouds& all, const question& q) {
    return brute_support(s, all, q);
  }
  static question of_frame(std::size_t number, std::size_t) {
    return {.min_points = number % 2 == 1 ? 2u : 3u, .radius = 0.1};
  }
  static std::vector<question> refused() { return {{.min_points = 0}}; }
  void saw(const clearance::supported_distance& r) { isolated += r.isolated, confirmed += r.cloud != clearance::none; }
};

}  // namespace testing
