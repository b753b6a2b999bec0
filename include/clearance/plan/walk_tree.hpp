// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// One host thread walks the trees over points and parts, nearest first.

#include <clearance/plan/tree_search.hpp>

#include <algorithm>
#include <vector>

namespace clearance::minimum {

/// A pair that is still to be opened. The nearest goes first.
template <class Pair, class Order>
struct pending_pair {
  Order order;
  Pair pair;

  friend bool operator<(const pending_pair& a, const pending_pair& b) { return a.order > b.order; }
};

/// One configuration against one cloud. `pending` is memory to work with.
template <class Search>
void walk_trees(const Search& search,
                std::vector<pending_pair<typename Search::pair, typename Search::order_type>>& pending) {
  const auto push = [&](const typename Search::pair& p) {
    pending.push_back({search.order(p), p});
    std::push_heap(pending.begin(), pending.end());
  };
  pending.clear();
  typename Search::pair next;
  for (std::uint32_t i = 0, count = search.starts(); i < count; ++i)
    if (search.start(i, next)) push(next);
  while (!pending.empty()) {
    std::pop_heap(pending.begin(), pending.end());
    const typename Search::pair top = pending.back().pair;
    pending.pop_back();
    if (search.settled(top)) continue;
    if (search.is_small(top)) {
      search.look_at_points(top);
      continue;
    }
    for (std::uint32_t j = 0, count = search.children(top); j < count; ++j)
      if (search.child(top, j, next)) push(next);
  }
}

}  // namespace clearance::minimum
