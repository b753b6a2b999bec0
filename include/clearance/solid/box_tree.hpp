// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A tree of boxes in double, by which solids find what is nearest, exactly.

#include <clearance/ground/math.hpp>
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
};

/// What searches of a box tree read, on host and device.
struct box_tree_view {
  const box_pair* nodes = nullptr;
  const std::uint32_t* order = nullptr;
  std::uint32_t items = 0, root = 0;

  static constexpr int stack_size = 96;

  /// Calls `visit(item, best)` for each item whose box is within `best` of p, near ones first. `visit` returns the new
  /// best, never above the old. Returns the last best; stops early once that is at most `enough`.
  CLEARANCE_CALLS_ANYTHING
  template <class F>
  CLEARANCE_HD double nearest(const vec3d& p, double best, F visit, double enough = -double(infinity)) const {
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
  explicit box_tree(std::span<const Eigen::AlignedBox3d> boxes) : order_(boxes.size()) {
    for (std::uint32_t i = 0; i < order_.size(); ++i) order_[i] = i;
    if (boxes.empty()) return;
    nodes_.reserve(boxes.size());
    std::vector<Eigen::Vector3d> middles(boxes.size());
    for (std::size_t i = 0; i < boxes.size(); ++i) middles[i] = boxes[i].center();
    root_ = split(boxes, middles, 0, std::uint32_t(boxes.size()));
  }

  std::size_t size() const { return order_.size(); }

  /// What searches read; the same for host and device copies of `nodes()` and `order()`.
  box_tree_view view() const { return {nodes_.data(), order_.data(), std::uint32_t(order_.size()), root_}; }
  std::span<const box_pair> nodes() const { return nodes_; }
  std::span<const std::uint32_t> order() const { return order_; }

  template <class F>
  double nearest(const Eigen::Vector3d& p, double best, F visit) const {
    return view().nearest(p, best, visit);
  }

  /// Calls `visit(item)` for each item whose box is within `reach` of p.
  template <class F>
  void within(const Eigen::Vector3d& p, double reach, F visit) const {
    nearest(p, reach, [&](std::uint32_t item, double best) { return visit(item), best; });
  }

 private:
  static constexpr std::uint32_t leaf_bit = box_pair::leaf_bit, leaf_size = 4;
  static constexpr int deepest = 64;

  std::uint32_t split(std::span<const Eigen::AlignedBox3d> boxes, const std::vector<Eigen::Vector3d>& middles,
                      std::uint32_t first, std::uint32_t last, int level = 0) {
    const std::uint32_t count = last - first;
    if (count <= leaf_size) return leaf_bit | first << 3 | (count - 1);
    const std::uint32_t middle = level < deepest / 2 ? cut(boxes, middles, first, last) : halve(middles, first, last);
    const std::uint32_t at = std::uint32_t(nodes_.size());
    nodes_.emplace_back();
    for (int k = 0; k < 2; ++k) {
      const std::uint32_t begin = k == 0 ? first : middle, end = k == 0 ? middle : last;
      Eigen::AlignedBox3d box;
      for (std::uint32_t i = begin; i < end; ++i) box.extend(boxes[order_[i]]);
      for (int i = 0; i < 3; ++i) {
        nodes_[at].low[k][i] = std::nextafter(float(box.min()[i]), -std::numeric_limits<float>::infinity());
        nodes_[at].high[k][i] = std::nextafter(float(box.max()[i]), std::numeric_limits<float>::infinity());
      }
      const std::uint32_t child = split(boxes, middles, begin, end, level + 1);
      nodes_[at].child[k] = child;
    }
    return at;
  }

  std::uint32_t halve(const std::vector<Eigen::Vector3d>& middles, std::uint32_t first, std::uint32_t last) {
    Eigen::AlignedBox3d spread;
    for (std::uint32_t i = first; i < last; ++i) spread.extend(middles[order_[i]]);
    int axis;
    spread.sizes().maxCoeff(&axis);
    const std::uint32_t middle = first + (last - first) / 2;
    std::nth_element(order_.begin() + first, order_.begin() + middle, order_.begin() + last, [&](auto a, auto b) {
      return middles[a][axis] != middles[b][axis] ? middles[a][axis] < middles[b][axis] : a < b;
    });
    return middle;
  }

  std::uint32_t cut(std::span<const Eigen::AlignedBox3d> boxes, const std::vector<Eigen::Vector3d>& middles,
                    std::uint32_t first, std::uint32_t last) {
    constexpr int bins = 16;
    Eigen::AlignedBox3d spread;
    for (std::uint32_t i = first; i < last; ++i) spread.extend(middles[order_[i]]);
    const auto area = [](const Eigen::AlignedBox3d& b) {
      const Eigen::Vector3d s = b.sizes();
      return s.x() * s.y() + s.y() * s.z() + s.z() * s.x();
    };
    const auto bin = [&](std::uint32_t item, int axis) {
      const double t = (middles[item][axis] - spread.min()[axis]) / (spread.max()[axis] - spread.min()[axis]);
      return std::min(bins - 1, int(t * bins));
    };
    double cheapest = std::numeric_limits<double>::infinity();
    int best_axis = -1, best_bin = 0;
    for (int axis = 0; axis < 3; ++axis) {
      if (!(spread.max()[axis] - spread.min()[axis] > 1e-300)) continue;
      std::array<Eigen::AlignedBox3d, bins> box;
      std::array<std::uint32_t, bins> count{};
      for (std::uint32_t i = first; i < last; ++i) {
        const int b = bin(order_[i], axis);
        box[b].extend(boxes[order_[i]]);
        ++count[b];
      }
      std::array<double, bins> left{};
      Eigen::AlignedBox3d grown;
      std::uint32_t n = 0;
      for (int b = 0; b + 1 < bins; ++b) {
        grown.extend(box[b]);
        n += count[b];
        left[b] = n == 0 ? std::numeric_limits<double>::infinity() : n * area(grown);
      }
      grown.setEmpty();
      n = 0;
      for (int b = bins - 1; b > 0; --b) {
        grown.extend(box[b]);
        n += count[b];
        const double cost = n == 0 ? std::numeric_limits<double>::infinity() : left[b - 1] + n * area(grown);
        if (cost < cheapest) cheapest = cost, best_axis = axis, best_bin = b;
      }
    }
    if (best_axis < 0) return halve(middles, first, last);
    const auto middle = std::stable_partition(order_.begin() + first, order_.begin() + last,
                                              [&](std::uint32_t item) { return bin(item, best_axis) < best_bin; });
    return std::uint32_t(middle - order_.begin());
  }

  std::vector<box_pair> nodes_;
  std::vector<std::uint32_t> order_;
  std::uint32_t root_ = 0;
};

}  // namespace clearance
