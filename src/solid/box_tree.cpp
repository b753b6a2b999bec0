// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/solid/box_tree.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace clearance {

namespace {

constexpr std::uint32_t leaf_bit = box_pair::leaf_bit, leaf_size = 4;
constexpr int deepest = 64;

}  // namespace

box_tree::box_tree(std::span<const Eigen::AlignedBox3d> boxes) : order_(boxes.size()) {
  for (std::uint32_t i = 0; i < order_.size(); ++i) order_[i] = i;
  if (boxes.empty()) return;
  nodes_.reserve(boxes.size());
  std::vector<Eigen::Vector3d> middles(boxes.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) middles[i] = boxes[i].center();
  root_ = split(boxes, middles, 0, std::uint32_t(boxes.size()), 0);
}

std::uint32_t box_tree::split(std::span<const Eigen::AlignedBox3d> boxes, const std::vector<Eigen::Vector3d>& middles,
                              std::uint32_t first, std::uint32_t last, int level) {
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

std::uint32_t box_tree::halve(const std::vector<Eigen::Vector3d>& middles, std::uint32_t first, std::uint32_t last) {
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

std::uint32_t box_tree::cut(std::span<const Eigen::AlignedBox3d> boxes, const std::vector<Eigen::Vector3d>& middles,
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
      if (cost < cheapest) {
        cheapest = cost;
        best_axis = axis;
        best_bin = b;
      }
    }
  }
  if (best_axis < 0) return halve(middles, first, last);
  const auto middle = std::stable_partition(order_.begin() + first, order_.begin() + last,
                                            [&](std::uint32_t item) { return bin(item, best_axis) < best_bin; });
  return std::uint32_t(middle - order_.begin());
}

}  // namespace clearance
