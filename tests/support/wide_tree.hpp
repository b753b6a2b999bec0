// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The widest possible tree: a root, and a leaf for each primitive. Its nodes are not integers.

#include <clearance/concepts.hpp>

namespace testing {

template <clearance::bounding_volume V, clearance::primitive P>
struct wide_view {
  struct node_type {
    std::uint32_t which;
  };
  using volume_type = V;
  using primitive_type = P;

  const V* volumes;  // the root's first
  const P* primitives;
  std::uint32_t count;

  CLEARANCE_HD node_type root() const { return {0}; }
  CLEARANCE_HD bool is_leaf(node_type n) const { return n.which != 0; }
  CLEARANCE_HD std::uint32_t size(node_type n) const { return n.which == 0 ? count : 1; }
  CLEARANCE_HD node_type child(node_type, std::uint32_t k) const { return {k + 1}; }
  CLEARANCE_HD const V& volume(node_type n) const { return volumes[n.which]; }
  CLEARANCE_HD const P& primitive(node_type n, std::uint32_t) const { return primitives[n.which - 1]; }
  CLEARANCE_HD std::uint32_t id(node_type n, std::uint32_t) const { return n.which - 1; }
  CLEARANCE_HD std::uint32_t depth() const { return 1; }
  CLEARANCE_HD std::uint32_t width() const { return count; }
};

/// The volumes of the root and of each primitive.
template <clearance::bounding_volume V, clearance::primitive P>
std::vector<V> wide_volumes(const std::vector<P>& primitives) {
  std::vector<clearance::ball> all;
  std::vector<V> volumes(1);
  for (const P& p : primitives) {
    const auto balls = p.balls();
    all.insert(all.end(), balls.begin(), balls.end());
    volumes.push_back(clearance::bounding_volume_traits<V>::fit(balls));
  }
  volumes[0] = clearance::bounding_volume_traits<V>::fit(all);
  return volumes;
}

}  // namespace testing
