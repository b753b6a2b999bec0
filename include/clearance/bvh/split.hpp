// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace clearance {

/// What a split rule sees of a primitive: its number, and the box around its balls.
struct split_item {
  std::uint32_t id;
  Eigen::Vector3f lower, upper;

  Eigen::Vector3f center() const { return (lower + upper) / 2; }
};

/// The order of centres along a direction.
struct center_order {
  Eigen::Vector3f direction;
  bool operator()(const split_item& a, const split_item& b) const {
    const float x = a.center().dot(direction), y = b.center().dot(direction);
    return x < y || (x == y && a.id < b.id);
  }
};

/// The unit direction in which the centres spread most.
inline Eigen::Vector3f principal_direction(std::span<const split_item> items) {
  Eigen::Vector3f mean = Eigen::Vector3f::Zero();
  for (const auto& i : items) mean += i.center() / float(items.size());
  Eigen::Matrix3f covariance = Eigen::Matrix3f::Zero();
  for (const auto& i : items) covariance += (i.center() - mean) * (i.center() - mean).transpose();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> solver;
  solver.computeDirect(covariance);
  const Eigen::Vector3f principal = solver.eigenvectors().col(2);
  return principal.allFinite() && principal.norm() > 0.5f ? principal : Eigen::Vector3f::UnitX();
}

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

/// Split rule: the middle along the direction in which the centres spread most.
struct principal_split {
  std::size_t operator()(std::span<split_item> items) const {
    const auto middle = items.begin() + std::ptrdiff_t(items.size() / 2);
    std::nth_element(items.begin(), middle, items.end(), center_order{principal_direction(items)});
    return items.size() / 2;
  }
};

/// Split rule: two clusters around their mean centres (Lloyd 1982), started from halves along the principal direction.
/// Neither side gets less than a tenth, so that the depth stays logarithmic. Batch neural gas (Weller & Zachmann 2009)
/// does the same for two clusters once its neighbourhood has shrunk.
struct two_means_split {
  std::size_t operator()(std::span<split_item> items) const {
    const std::size_t n = items.size(), least = std::max<std::size_t>(1, n / 10);
    std::sort(items.begin(), items.end(), center_order{principal_direction(items)});
    std::size_t cut = n / 2;
    for (int round = 0; round < 16; ++round) {
      // The clusters meet in the plane between their means, so a cut along the way between the means separates them.
      const Eigen::Vector3f near = mean(items.first(cut)), far = mean(items.subspan(cut)), way = far - near;
      if (!(way.norm() > 0)) break;
      std::sort(items.begin(), items.end(), center_order{way});
      const float middle = (near + far).dot(way) / 2;
      const auto beyond =
          std::find_if(items.begin(), items.end(), [&](const auto& i) { return i.center().dot(way) > middle; });
      const auto now = std::clamp(std::size_t(beyond - items.begin()), least, n - least);
      if (now == cut && round > 0) break;
      cut = now;
    }
    return cut;
  }

 private:
  static Eigen::Vector3f mean(std::span<const split_item> items) {
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    for (const auto& i : items) sum += i.center();
    return sum / float(items.size());
  }
};

/// Split rule: two clusters by batch neural gas (Cottrell et al. 2006), as Weller & Zachmann (2009) split inner sphere
/// trees. Each item pulls the nearer mean by its volume and the farther mean by ever less of it, so the start matters
/// little. Neither side gets less than a tenth, so that the depth stays logarithmic.
struct neural_gas_split {
  std::size_t operator()(std::span<split_item> items) const {
    const std::size_t n = items.size(), least = std::max<std::size_t>(1, n / 10);
    constexpr int rounds = 24;
    const Eigen::Vector3f principal = principal_direction(items);
    std::sort(items.begin(), items.end(), center_order{principal});
    std::array<Eigen::Vector3f, 2> mean = {items[n / 4].center(), items[n - 1 - n / 4].center()};
    for (int round = 0; round < rounds; ++round) {
      const float width =
          std::pow(0.01f, float(round) / (rounds - 1));  // of the neighbourhood: shrinks from one rank to a hundredth
      const std::array<float, 2> pull = {1, std::exp(-1 / width)};
      std::array<Eigen::Vector3f, 2> sum = {Eigen::Vector3f::Zero(), Eigen::Vector3f::Zero()};
      std::array<float, 2> all = {0, 0};
      for (const auto& i : items) {
        const std::size_t near = (i.center() - mean[1]).squaredNorm() < (i.center() - mean[0]).squaredNorm();
        const float volume = (i.upper - i.lower).prod();
        for (const std::size_t k : {near, 1 - near}) {
          const float by = pull[k != near] * volume;
          sum[k] += by * i.center(), all[k] += by;
        }
      }
      for (std::size_t k = 0; k < 2; ++k)
        if (all[k] > 0 && sum[k].allFinite()) mean[k] = sum[k] / all[k];
    }
    Eigen::Vector3f way = mean[1] - mean[0];
    if (!(way.norm() > 0) || !way.allFinite()) way = principal;
    std::sort(items.begin(), items.end(), center_order{way});
    const float middle = (mean[0] + mean[1]).dot(way) / 2;
    const auto beyond =
        std::find_if(items.begin(), items.end(), [&](const auto& i) { return i.center().dot(way) > middle; });
    return std::clamp(std::size_t(beyond - items.begin()), least, n - least);
  }
};

/// Split rule: the cut with the least surface-area cost (Goldsmith & Salmon 1987), along one of the three axes or the
/// principal one. Neither side gets less than a third, so that the depth stays logarithmic. The default.
struct surface_area_split {
  std::size_t operator()(std::span<split_item> items) const {
    const std::size_t n = items.size(), least = std::max<std::size_t>(1, n / 3);
    float best = std::numeric_limits<float>::infinity();
    Eigen::Vector3f best_direction = Eigen::Vector3f::UnitX();
    std::size_t cut = n / 2;
    std::vector<float> left(n);
    for (const Eigen::Vector3f& direction : directions(items)) {
      std::sort(items.begin(), items.end(), center_order{direction});
      sweep(items.begin(), items.end(), left.begin());
      std::vector<float> right(n);
      sweep(items.rbegin(), items.rend(), right.begin());
      for (std::size_t k = least; k + least <= n; ++k) {
        const float cost = float(k) * left[k - 1] + float(n - k) * right[n - k - 1];
        if (cost < best) best = cost, cut = k, best_direction = direction;
      }
    }
    std::sort(items.begin(), items.end(), center_order{best_direction});
    return cut;
  }

 private:
  template <class In, class Out>
  static void sweep(In first, In last, Out area) {
    Eigen::Vector3f lo = first->lower, hi = first->upper;
    for (; first != last; ++first, ++area) {
      lo = lo.cwiseMin(first->lower), hi = hi.cwiseMax(first->upper);
      const Eigen::Vector3f d = hi - lo;
      *area = d.x() * d.y() + d.y() * d.z() + d.z() * d.x();
    }
  }
  static std::array<Eigen::Vector3f, 4> directions(std::span<const split_item> items) {
    return {Eigen::Vector3f::UnitX(), Eigen::Vector3f::UnitY(), Eigen::Vector3f::UnitZ(), principal_direction(items)};
  }
};

}  // namespace clearance
