// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Goes greedily to one leaf, for a bound that a real primitive attains.

#include <clearance/concepts.hpp>

namespace clearance::scan {

/// A team of one thread.
struct alone {
  static constexpr std::uint32_t size = 1;
  CLEARANCE_HD std::uint32_t rank() const { return 0; }
  CLEARANCE_HD bool any(bool mine) const { return mine; }
  CLEARANCE_HD real least(real mine) const { return mine; }
  CLEARANCE_HD int first(bool mine) const { return mine ? 0 : -1; }
  CLEARANCE_HD bool is(int) const { return true; }
  template <class T>
  CLEARANCE_HD T from(int, const T& mine) const {
    return mine;
  }
};

/// A tree as `descend` takes it.
template <hierarchy H>
struct plain_steps {
  using node_type = typename H::node_type;
  using volume_type = typename H::volume_type;
  struct step {
    node_type node;
    volume_type volume;
  };
  const H& tree;

  CLEARANCE_HD node_type root() const { return tree.root(); }
  CLEARANCE_HD bool is_leaf(node_type n) const { return tree.is_leaf(n); }
  CLEARANCE_HD std::uint32_t size(node_type n) const { return tree.size(n); }
  CLEARANCE_HD step child(node_type n, std::uint32_t j) const {
    const node_type c = tree.child(n, j);
    return {c, tree.volume(c)};
  }
  CLEARANCE_HD real distance(node_type n, std::uint32_t j, vec3 q) const { return tree.primitive(n, j).distance(q); }
};

/// Observers of `nearest_leaf`: `passed` gets the bounds of volumes that are left aside, `wants` says how far to go.
struct nobody {
  CLEARANCE_HD void passed(real) {}
  CLEARANCE_HD bool wants(real) const { return true; }
};
struct nearest_passed {
  real reach, bound = infinity;

  CLEARANCE_HD void passed(real lower) {
    if (lower < bound) bound = lower;
  }
  CLEARANCE_HD bool wants(real lower) const { return lower <= reach; }
};

/// Goes from the root always to the child whose volume is nearest, and returns the leaf. `live` becomes false if that
/// leads nowhere. Threads that are not `live` take part. `others` gets this thread's share of what is left aside.
template <class Steps, class Team = alone, class Others = nobody>
CLEARANCE_HD typename Steps::node_type nearest_leaf(const Steps& steps, vec3 q, bool& live, const Team& team = {},
                                                    Others&& others = {}) {
  using traits = bounding_volume_traits<typename Steps::volume_type>;
  typename Steps::node_type n{};
  if (live) n = steps.root();
  bool inner = live && !steps.is_leaf(n);

  while (team.any(inner)) {
    const std::uint32_t size = inner ? steps.size(n) : 0;
    typename Steps::node_type best = n;
    real least = infinity;
    CLEARANCE_ROLLED
    for (std::uint32_t j = team.rank(); j < size; j += Team::size) {
      const auto step = steps.child(n, j);
      const real lb = traits::lower_bound(step.volume, q);
      others.passed(lb < least ? least : lb);
      if (lb < least) {
        least = lb;
        best = step.node;
      }
    }

    const real nearest = team.least(least);
    const int winner = team.first(least < infinity && least == nearest);
    if (!team.is(winner)) others.passed(least);
    best = team.from(winner, best);
    if (inner) {
      live = winner >= 0 && others.wants(nearest);
      n = best;
      inner = live && !steps.is_leaf(n);
    }
  }
  return n;
}

/// The distance to that leaf's primitives, or to this thread's share of them in a team. Infinite if there is none.
template <class Steps, class Team = alone>
CLEARANCE_HD real descend(const Steps& steps, vec3 q, bool live = true, const Team& team = {}) {
  const typename Steps::node_type n = nearest_leaf(steps, q, live, team);
  real d = infinity;
  const std::uint32_t size = live ? steps.size(n) : 0;
  CLEARANCE_ROLLED
  for (std::uint32_t j = team.rank(); j < size; j += Team::size) d = min(d, steps.distance(n, j, q));
  return d;
}

}  // namespace clearance::scan
