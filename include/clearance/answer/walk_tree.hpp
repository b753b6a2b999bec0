// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Down a tree over points by one thread, nearest first.

#include <clearance/answer/tree_search.hpp>

#include <algorithm>

namespace clearance::minimum {

/// A node that is still to be opened for one part. It goes before all that are not nearer.
struct pending_node {
  distance_key order;
  real bound;
  std::uint32_t least, level, node, part;
};

/// One configuration against one cloud. `pending` is memory to work with.
template <class Search>
class tree_walk {
 public:
  tree_walk(const Search& search, std::vector<pending_node>& pending) : search_(search), pending_(pending) {}

  void run() {
    const auto& tree = search_.tree;
    pending_.clear();
    for (std::uint32_t k = 0; k < search_.body.part_count && tree.levels != 0; ++k)
      open(tree.levels - 1, 0, tree.size(tree.levels - 1), {}, -infinity, k);
    while (!pending_.empty()) {
      std::pop_heap(pending_.begin(), pending_.end(), after);
      const pending_node top = pending_.back();
      pending_.pop_back();
      if (search_.settled(top.bound, top.least)) continue;
      const std::uint32_t begin = tree.first_below(top.level, top.node), end = tree.end_below(top.level, top.node);
      const ball& around = tree.balls[tree.begin[top.level] + top.node];
      if (top.level != 0)
        open(top.level - 1, begin, end, around, top.bound, top.part);
      else
        visit(begin, end, around, top.bound, top.part);
    }
  }

 private:
  static bool after(const pending_node& a, const pending_node& b) { return a.order > b.order; }

  /// Children of a node that is not nearer to part k than `bound`.
  void open(std::uint32_t level, std::uint32_t begin, std::uint32_t end, const ball& around, real bound, std::uint32_t k) {
    for (std::uint32_t n = begin; n < end; ++n) {
      const std::uint32_t here = search_.tree.begin[level] + n;
      const ball& b = search_.tree.balls[here];
      if (!search_.may_reach(around, bound, b.center, b.radius) || !search_.may_reach(b, k)) continue;
      const real nearest = search_.look(b, k);
      if (!(nearest < infinity)) continue;
      const std::uint32_t least = search_.tree.least[here];
      pending_.push_back({Search::order(nearest, least), nearest, least, level, n, k});
      std::push_heap(pending_.begin(), pending_.end(), after);
    }
  }

  void visit(std::uint32_t begin, std::uint32_t end, const ball& around, real bound, std::uint32_t k) {
    for (std::uint32_t i = begin; i < end; ++i)
      if (const auto& p = search_.tree.points[i]; search_.may_reach(around, bound, p.at, 0)) search_.visit(p, k);
  }

  const Search& search_;
  std::vector<pending_node>& pending_;
};

}  // namespace clearance::minimum
