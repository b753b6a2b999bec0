// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A question of one's own: the three nearest primitives of one point. A visitor is one small object; every traversal
// walks for it, over every tree, on the CPU or inside one's own kernel.

#include <clearance/bvh/build.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/traversal/near_first.hpp>
#include <clearance/volume/sphere.hpp>

#include <algorithm>
#include <cstdio>

// [visitor]
struct three_nearest {
  struct result_type {
    clearance::real distance[3];
    std::uint32_t primitive[3];
  };

  result_type best = {{clearance::infinity, clearance::infinity, clearance::infinity}, {~0u, ~0u, ~0u}};

  /// What is farther than the third need not be shown any more.
  CLEARANCE_HD clearance::real reach() const { return best.distance[2]; }

  /// In any order; of equally distant ones the lowest number wins, so ties do not depend on the tree.
  CLEARANCE_HD void offer(std::uint32_t id, clearance::real distance) {
    for (int k = 0; k < 3; ++k) {
      const bool before = distance < best.distance[k] || (distance == best.distance[k] && id < best.primitive[k]);
      if (!before) continue;
      const clearance::real pushed = best.distance[k];
      const std::uint32_t pushed_id = best.primitive[k];
      best.distance[k] = distance, best.primitive[k] = id;
      distance = pushed, id = pushed_id;
    }
  }
  CLEARANCE_HD result_type result() const { return best; }
};

static_assert(clearance::explain_visitor<three_nearest>());
// [visitor]

inline std::vector<clearance::inner_sphere> spheres() {
  std::vector<clearance::inner_sphere> all;
  for (int k = 0; k < 1000; ++k) all.push_back({{0.01f * (k % 10), 0.01f * (k / 10 % 10), 0.01f * (k / 100)}, 0.004f});
  return all;
}

inline std::vector<clearance::vec3> points() {
  std::vector<clearance::vec3> all;
  for (int k = 0; k < 500; ++k) all.push_back({0.2f - 0.0003f * k, 0.0001f * k, 0.05f});
  return all;
}

/// 0 if every answer is that of a plain sort.
inline int check(const std::vector<three_nearest::result_type>& answers) {
  for (std::size_t i = 0; i < answers.size(); ++i) {
    std::vector<std::pair<clearance::real, std::uint32_t>> all;
    for (const auto& s : spheres()) all.push_back({s.distance(points()[i]), std::uint32_t(all.size())});
    std::ranges::sort(all);
    for (int k = 0; k < 3; ++k)
      if (answers[i].distance[k] != all[k].first || answers[i].primitive[k] != all[k].second) return 1;
  }
  const auto& last = answers.back();
  std::printf("nearest to the last point: %u, %u and %u, the third %.6f m away\n", last.primitive[0], last.primitive[1],
              last.primitive[2], last.distance[2]);
  return answers.size() == points().size() ? 0 : 1;
}
