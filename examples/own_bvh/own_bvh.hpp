// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Somebody else's tree and no tree at all, through the same query. A view of what is there is all it takes.

#include "their_tree.hpp"

#include <clearance/bvh/flat_list.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/volume/aabb.hpp>

#include <bit>
#include <cstdio>

// [view]
/// A clearance::hierarchy over their nodes: a pointer and a number, copied to wherever the query runs.
struct their_view {
  using node_type = const theirs::node*;
  using volume_type = clearance::aabb;
  using primitive_type = clearance::inner_sphere;

  node_type top;
  std::uint32_t levels;

  CLEARANCE_HD node_type root() const { return top; }
  CLEARANCE_HD bool is_leaf(node_type n) const { return n->left == nullptr; }
  CLEARANCE_HD std::uint32_t size(node_type n) const { return is_leaf(n) ? 1 : 2; }
  CLEARANCE_HD node_type child(node_type n, std::uint32_t k) const { return k == 0 ? n->left : n->right; }
  CLEARANCE_HD std::uint32_t id(node_type n, std::uint32_t) const { return std::uint32_t(n->content.number); }
  CLEARANCE_HD std::uint32_t depth() const { return levels; }
  CLEARANCE_HD std::uint32_t width() const { return 2; }

  /// By value, because they store neither a clearance::aabb nor a clearance::inner_sphere.
  CLEARANCE_HD primitive_type primitive(node_type n, std::uint32_t) const {
    return {{n->content.x, n->content.y, n->content.z}, n->content.r};
  }
  /// Their boxes were rounded to nearest, so they are widened by more than that could have cost.
  CLEARANCE_HD volume_type volume(node_type n) const {
    return {{wider(n->low[0], -1), wider(n->low[1], -1), wider(n->low[2], -1)},
            {wider(n->high[0], 1), wider(n->high[1], 1), wider(n->high[2], 1)}};
  }

 private:
  CLEARANCE_HD static clearance::real wider(float x, float sign) {
    return x + sign * clearance::slack * (clearance::absolute(x) + 1);  // their robot is smaller than 1 m
  }
};

static_assert(clearance::explain_hierarchy<their_view>());
// [view]

// [ask]
/// One part of your own: its view, and a ball around it (`facts`).
template <class Backend, clearance::hierarchy Tree>
clearance::min_distance_result ask(const Backend& on, const Tree& tree, const clearance::part_facts& facts,
                                   std::span<const clearance::vec3> cloud) {
  const clearance::part_view<Tree> view{tree, {}, facts};
  const auto there = on.copy_in(std::span(&view, 1));
  const clearance::model_view<clearance::part_view<Tree>> robot{there.data(), {&facts, 1}, tree.depth(), tree.width()};
  const Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  return clearance::ask(on, robot, std::span(&pose, 1), clearance::point_span(cloud), clearance::min_distance{});
}
// [ask]

/// `memory` is read where `on` runs, so it is the caller's to choose.
template <clearance::backend Backend>
int example(const Backend& on, std::span<theirs::node> memory) {
  std::vector<theirs::ball> balls;
  std::vector<clearance::inner_sphere> spheres;
  for (int k = 0; k < 300; ++k) {
    const float turn = 0.1f * k;
    balls.push_back({0.3f * std::cos(turn), 0.3f * std::sin(turn), 0.002f * k, 0.02f, k});
    spheres.push_back({{balls.back().x, balls.back().y, balls.back().z}, balls.back().r});
  }
  std::vector<clearance::vec3> cloud;
  for (int k = 0; k < 4000; ++k) cloud.push_back({1 - 0.0005f * k, 0.5f, 0.0002f * k});

  const clearance::ball around = clearance::enclosing_ball(std::span<const clearance::inner_sphere>(spheres));
  const clearance::part_facts facts{.center = around.center, .radius = around.radius};
  const auto levels = std::uint32_t(std::bit_width(balls.size() - 1));
  const auto linked = ask(on, their_view{theirs::grow(balls, memory), levels}, facts, cloud);

  const auto there = on.copy_in(std::span<const clearance::inner_sphere>(spheres));
  std::vector<clearance::ball> all;
  for (const auto& s : spheres) all.push_back({s.center, s.radius});
  const clearance::flat_list<clearance::aabb, clearance::inner_sphere> list{clearance::aabb::fit(all), there.data(),
                                                                            300};
  const auto flat = ask(on, list, facts, cloud);

  std::printf("linked: %.6f m, point %u, ball %u; flat: %.6f m, point %u, ball %u\n", linked.distance, linked.point,
              linked.primitive, flat.distance, flat.point, flat.primitive);
  const bool same =
      linked.distance == flat.distance && linked.point == flat.point && linked.primitive == flat.primitive;
  return same && linked.state == clearance::state::free ? 0 : 1;
}
