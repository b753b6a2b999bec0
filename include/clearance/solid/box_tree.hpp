// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A tree of boxes in double, by which solids find what is nearest, exactly.

#include <clearance/ground/math.hpp>
#include <clearance/solid/eight.hpp>
#include <clearance/solid/vec3d.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace clearance {

/// Two children of a node in a box tree.
struct box_pair {
  float low[2][3], high[2][3];
  std::uint32_t child[2];  ///< A node, or leaf_bit | first item << 3 | items - 1.

  static constexpr std::uint32_t leaf_bit = 1u << 31;
  CLEARANCE_HD double squared(int k, const vec3d& p) const {
    const double at[3] = {p.x, p.y, p.z};
    double sum = 0;
    for (int i = 0; i < 3; ++i) {
      const double below = low[k][i] - at[i], above = at[i] - high[k][i];
      const double d = below > above ? below : above;
      if (d > 0) sum += d * d;
    }
    return sum;
  }
  /// That of the nearest of the eighths' middles, or less.
  double squared(int k, const eighths& p) const {
    const double at[3] = {p.middle.x, p.middle.y, p.middle.z};
    double sum = 0;
    for (int i = 0; i < 3; ++i) {
      const double below = low[k][i] - at[i], above = at[i] - high[k][i];
      const double d = (below > above ? below : above) - p.apart * (1 + 1e-9);
      if (d > 0) sum += d * d;
    }
    return sum;
  }
};

/// What searches of a box tree read, on host and device.
struct box_tree_view {
  const box_pair* nodes = nullptr;
  const std::uint32_t* order = nullptr;
  std::uint32_t items = 0, root = 0;

  static constexpr int stack_size = 96;

  /// Calls `visit(item, best)` for each item whose box is within `best` of p, near ones first. `visit` returns the new
  /// best, never above the old. Returns the last best; stops early once that is at most `enough`. On the host p may
  /// also be a cube's eighths: then `best` is the largest of theirs.
  CLEARANCE_CALLS_ANYTHING
  template <class P, class F>
  CLEARANCE_HD double nearest(const P& p, double best, F visit, double enough = -double(infinity)) const {
    if (items == 0) return best;
    struct {
      double distance;
      std::uint32_t child;
    } stack[stack_size];
    int top = 0;
    std::uint32_t at = root;
    for (;;) {
      if (at & box_pair::leaf_bit) {
        const std::uint32_t first = (at & ~box_pair::leaf_bit) >> 3, count = (at & 7) + 1;
        for (std::uint32_t i = first; i < first + count; ++i) best = visit(order[i], best);
        if (best <= enough) return best;
      } else {
        const box_pair& n = nodes[at];
        const double left = n.squared(0, p), right = n.squared(1, p), reach = best > 0 ? best * best : 0;
        const int near = right < left;
        const double nearer = near ? right : left, farther = near ? left : right;
        if (farther <= reach) stack[top++] = {farther, n.child[1 - near]};
        if (nearer <= reach) {
          at = n.child[near];
          continue;
        }
      }
      for (;;) {
        if (top == 0) return best;
        --top;
        if (stack[top].distance <= (best > 0 ? best * best : 0)) break;
      }
      at = stack[top].child;
    }
  }
};

/// A binary tree of boxes for exact nearest searches in double on the host, split by the surface-area heuristic. Only
/// the caller knows what the boxes enclose.
class box_tree {
 public:
  box_tree() = default;
  explicit box_tree(std::span<const Eigen::AlignedBox3d> boxes);

  std::size_t size() const { return order_.size(); }

  /// What searches read; the same for host and device copies of `nodes()` and `order()`.
  box_tree_view view() const { return {nodes_.data(), order_.data(), std::uint32_t(order_.size()), root_}; }
  std::span<const box_pair> nodes() const { return nodes_; }
  std::span<const std::uint32_t> order() const { return order_; }

  template <class F>
  double nearest(const Eigen::Vector3d& p, double best, F visit) const {
    return view().nearest(vec3d(p), best, visit);
  }

  /// Calls `visit(item)` for each item whose box is within `reach` of p.
  template <class F>
  void within(const Eigen::Vector3d& p, double reach, F visit) const {
    nearest(p, reach, [&](std::uint32_t item, double best) {
      visit(item);
      return best;
    });
  }

 private:
  std::uint32_t split(std::span<const Eigen::AlignedBox3d> boxes, const std::vector<Eigen::Vector3d>& middles,
                      std::uint32_t first, std::uint32_t last, int level);
  std::uint32_t halve(const std::vector<Eigen::Vector3d>& middles, std::uint32_t first, std::uint32_t last);
  std::uint32_t cut(std::span<const Eigen::AlignedBox3d> boxes, const std::vector<Eigen::Vector3d>& middles,
                    std::uint32_t first, std::uint32_t last);

  std::vector<box_pair> nodes_;
  std::vector<std::uint32_t> order_;
  std::uint32_t root_ = 0;
};

}  // namespace clearance
