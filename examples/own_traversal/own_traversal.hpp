// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A traversal policy of one's own, under every question: the least distance, zones and every point's distance.

#include <clearance/make_model.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/questions/distances.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/questions/zones.hpp>
#include <clearance/volume/sphere.hpp>

#include <cmath>
#include <cstdio>

// [traversal]
/// Depth first, nearest child first. Of children that wait it keeps one bit each, in one entry for each level of the
/// tree, and computes their bounds again when it comes back to them.
struct entry_per_level {
  static constexpr std::uint32_t capacity = 32;  ///< Trees that need a larger stack are refused.

  template <class Tree>
  struct level {
    typename Tree::node_type node;
    std::uint32_t waiting;  ///< One bit for each child.
  };

  template <clearance::hierarchy Tree, clearance::visitor Query>
  CLEARANCE_HD void operator()(const Tree& tree, clearance::vec3 p, Query& q) const {
    level<Tree> path[capacity];
    std::uint32_t levels = 0;
    auto n = tree.root();
    bool here = clearance::bound_for(q, tree.volume(n), p) <= q.reach();  // NaN prunes; ties survive
    while (here || levels > 0) {
      if (here && tree.is_leaf(n)) {
        clearance::offer_leaf(tree, n, p, q);
        here = false;
        continue;
      }
      if (here) path[levels++] = {n, ~0u >> (32 - tree.size(n))};
      level<Tree>& last = path[levels - 1];
      here = take_nearest(tree, p, q, last, n);
      if (last.waiting == 0) --levels;  // so the path is never longer than the stack that the tree needs
    }
  }

 private:
  /// Takes the nearest child that waits, and lets those go that are out of reach: a reach never grows.
  template <class Tree, class Query>
  CLEARANCE_HD static bool take_nearest(const Tree& tree, clearance::vec3 p, const Query& q, level<Tree>& from,
                                        typename Tree::node_type& nearest) {
    clearance::real least = clearance::infinity;
    std::uint32_t taken = 0, left = 0;
    const std::uint32_t size = tree.size(from.node);
    for (std::uint32_t k = 0; k < size; ++k) {
      if ((from.waiting >> k & 1) == 0) continue;
      const auto child = tree.child(from.node, k);
      const clearance::real bound = clearance::bound_for(q, tree.volume(child), p);
      if (!(bound <= q.reach())) continue;
      left |= 1u << k;
      if (taken == 0 || bound < least) least = bound, taken = 1u << k, nearest = child;
    }
    from.waiting = left & ~taken;
    return taken != 0;
  }
};
// [traversal]

/// 0 if each answer is that of the library's own traversal.
template <clearance::backend Backend>
int example(const Backend& on) {
  std::vector<std::vector<clearance::inner_sphere>> links(2);
  for (int k = 0; k < 400; ++k) {
    links[0].push_back({{0.001f * k, 0, 0}, 0.05f});
    links[1].push_back({{0.06f * std::cos(0.1f * k), 0.06f * std::sin(0.1f * k), 0.001f * k}, 0.02f});
  }
  std::vector<Eigen::Isometry3d> poses(2, Eigen::Isometry3d::Identity());
  poses[1].translation() << 0.4, 0, 0;
  std::vector<clearance::vec3> cloud;
  for (int k = 0; k < 20000; ++k) cloud.push_back({0.003f * (k % 200), 0.002f * (k / 200) + 0.07f, 0.1f});

  // [use]
  const auto robot = clearance::make_model<clearance::sphere>(links).on(on);
  const clearance::plain mine{on, entry_per_level{}};  // in place of the backend, for any question
  const auto least = clearance::ask(mine, robot, poses, cloud, clearance::min_distance{});
  const auto zones = clearance::ask(mine, robot, poses, cloud, clearance::zones{.thresholds = {0.02, 0.1}});
  clearance::query each(mine, robot, clearance::distances{.d_max = 0.3});
  const auto distances = each(poses, cloud);
  // [use]
  std::printf("%.6f m to point %u; %llu points are within 0.1 m of link 1\n", double(least.distance), least.point,
              (unsigned long long)zones.of(1, 1).points);

  const auto their_least = clearance::ask(on, robot, poses, cloud, clearance::min_distance{});
  const auto their_zones = clearance::ask(on, robot, poses, cloud, clearance::zones{.thresholds = {0.02, 0.1}});
  const auto their_distances = clearance::ask(on, robot, poses, cloud, clearance::distances{.d_max = 0.3});
  bool same = least.distance == their_least.distance && least.point == their_least.point &&
              least.primitive == their_least.primitive && distances.distance == their_distances.distance;
  for (std::size_t k = 0; k < 4; ++k)
    same = same && zones.zones[k].points == their_zones.zones[k].points &&
           zones.zones[k].nearest == their_zones.zones[k].nearest &&
           zones.zones[k].nearest_point == their_zones.zones[k].nearest_point;
  return same && zones.of(1, 1).points > 100 ? 0 : 1;
}
