// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

namespace clearance {

/// What a split rule sees of a primitive: its number, and the box around its balls.
struct split_item {
  std::uint32_t id;
  Eigen::Vector3f lower, upper;

  Eigen::Vector3f center() const { return (lower + upper) / 2; }
};

/// Split rule: the middle along the widest axis. Gives the least depth.
struct median_split {
  std::size_t operator()(std::span<split_item> items) const {
    Eigen::Vector3f lo = items[0].center(), hi = lo;
    for (const auto& i : items) lo = lo.cwiseMin(i.center()), hi = hi.cwiseMax(i.center());
    int axis = 0;
    (hi - lo).maxCoeff(&axis);
    const auto middle = items.begin() + std::ptrdiff_t(items.size() / 2);
    std::nth_element(items.begin(), middle, items.end(), [axis](const split_item& a, const split_item& b) {
      const float x = a.center()[axis], y = b.center()[axis];
      return x < y || (x == y && a.id < b.id);
    });
    return items.size() / 2;
  }
};

/// Split rule: of the three axes and the principal one, the cut with the least surface-area cost (Goldsmith & Salmon
/// 1987); neither side gets less than a third, so that the depth stays logarithmic.
struct surface_area_split {
  std::size_t operator()(std::span<split_item> items) const {
    const std::size_t n = items.size(), least = std::max<std::size_t>(1, n / 3);
    float best = std::numeric_limits<float>::infinity();
    Eigen::Vector3f along = Eigen::Vector3f::UnitX();
    std::size_t cut = n / 2;
    std::vector<float> left(n);
    for (const Eigen::Vector3f& direction : directions(items)) {
      sort(items, direction);
      sweep(items.begin(), items.end(), left.begin());
      std::vector<float> right(n);
      sweep(items.rbegin(), items.rend(), right.begin());
      for (std::size_t k = least; k + least <= n; ++k) {
        const float cost = float(k) * left[k - 1] + float(n - k) * right[n - k - 1];
        if (cost < best) best = cost, cut = k, along = direction;
      }
    }
    sort(items, along);
    return cut;
  }

 private:
  static void sort(std::span<split_item> items, const Eigen::Vector3f& direction) {
    std::sort(items.begin(), items.end(), [&](const split_item& a, const split_item& b) {
      const float x = a.center().dot(direction), y = b.center().dot(direction);
      return x < y || (x == y && a.id < b.id);
    });
  }
  template <class In, class Out>
  static void sweep(In first, In last, Out area) {
    Eigen::Vector3f lo = first->lower, hi = first->upper;
    for (; first != last; ++first, ++area) {
      lo = lo.cwiseMin(first->lower), hi = hi.cwiseMax(first->upper);
      const Eigen::Vector3f d = hi - lo;
      *area = d.x() * d.y() + d.y() * d.z() + d.z() * d.x();
    }
  }
  static std::vector<Eigen::Vector3f> directions(std::span<const split_item> items) {
    std::vector<Eigen::Vector3f> all = {Eigen::Vector3f::UnitX(), Eigen::Vector3f::UnitY(), Eigen::Vector3f::UnitZ()};
    Eigen::Vector3f mean = Eigen::Vector3f::Zero();
    for (const auto& i : items) mean += i.center() / float(items.size());
    Eigen::Matrix3f covariance = Eigen::Matrix3f::Zero();
    for (const auto& i : items) covariance += (i.center() - mean) * (i.center() - mean).transpose();
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> solver;
    solver.computeDirect(covariance);
    const Eigen::Vector3f principal = solver.eigenvectors().col(2);
    if (principal.allFinite() && principal.norm() > 0.5f) all.push_back(principal);
    return all;
  }
};

}  // namespace clearance
