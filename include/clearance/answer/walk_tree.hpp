// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Down a tree over points by one thread, nearest first.

#include <clearance/answer/tree_search.hpp>

namespace clearance::minimum {

/// Parts of a configuration that a node may be near: a bit each, and the last bit for all from there on.
using part_set = std::uint64_t;
inline part_set just(std::uint32_t k) { return part_set(1) << (k < 63 ? k : 63); }

template <class Search>
class tree_walk {
 public:
  explicit tree_walk(const Search& search) : search_(search) {}

  void run() {
    const auto& tree = search_.tree;
    if (tree.levels == 0) return;
    open(tree.levels - 1, 0, tree.size(tree.levels - 1), {}, -infinity, ~part_set(0));
    while (count_ > 0) {
      const entry e = pending_[--count_];
      if (search_.settled(e.bound, e.least)) continue;
      const std::uint32_t begin = tree.first_below(e.level, e.node), end = tree.end_below(e.level, e.node);
      const ball& around = tree.balls[tree.begin[e.level] + e.node];
      if (e.level != 0) {
        open(e.level - 1, begin, end, around, e.bound, e.parts);
        continue;
      }
      for (std::uint32_t i = begin; i < end; ++i)
        for (std::uint32_t k = 0; k < search_.body.part_count; ++k)
          if ((e.parts & just(k)) != 0 && search_.may_reach(around, e.bound, tree.points[i].at, 0)) search_.visit(tree.points[i], k);
    }
  }

 private:
  using tree_type = std::remove_cvref_t<decltype(std::declval<Search>().tree)>;
  struct entry {
    real bound;
    std::uint32_t least, level, node;
    part_set parts;
  };

  static bool before(const entry& a, const entry& b) { return Search::order(a.bound, a.least) < Search::order(b.bound, b.least); }

  /// Children of a node that is not nearer than `bound`.
  void open(std::uint32_t level, std::uint32_t begin, std::uint32_t end, const ball& around, real bound, part_set among) {
    const std::uint32_t base = count_;
    for (std::uint32_t n = begin; n < end; ++n) {
      const std::uint32_t here = search_.tree.begin[level] + n;
      const ball& b = search_.tree.balls[here];
      if (!search_.may_reach(around, bound, b.center, b.radius)) continue;
      entry e{infinity, search_.tree.least[here], level, n, 0};
      for (std::uint32_t k = 0; k < search_.body.part_count; ++k) {
        if ((among & just(k)) == 0 || !search_.may_reach(b, k)) continue;
        const real least = search_.look(b, k);
        if (least < infinity) e.parts |= just(k), e.bound = min(e.bound, least);
      }
      if (e.parts == 0) continue;
      std::uint32_t at = count_++;  // the nearest on top
      for (; at > base && before(pending_[at - 1], e); --at) pending_[at] = pending_[at - 1];
      pending_[at] = e;
    }
  }

  const Search& search_;
  std::uint32_t count_ = 0;
  entry pending_[tree_type::most_levels * (tree_type::fan - 1) + 1];
};

}  // namespace clearance::minimum
