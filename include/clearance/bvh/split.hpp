// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// How a tree is built: rules that divide a node's primitives in two.

#include <clearance/ground/math.hpp>

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

namespace clearance::splits {

// The principal axis of a few numbers. It is written out, because Eigen's solver takes compilers longer to read and to
// instantiate than all else that builds a tree.

/// Sums in the order of Eigen's reductions: a tree that was built by Eigen's operators is built again, to the bit.
inline float sum_of(float x, float y, float z) { return x + (y + z); }
inline float plain_dot(vec3 a, vec3 b) { return sum_of(a.x * b.x, a.y * b.y, a.z * b.z); }
inline vec3 plain_cross(vec3 a, vec3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline vec3 times(float s, vec3 a) { return {s * a.x, s * a.y, s * a.z}; }
inline vec3 over(vec3 a, float s) { return {a.x / s, a.y / s, a.z / s}; }
inline float plain_length(vec3 a) { return std::sqrt(plain_dot(a, a)); }
inline bool all_finite(vec3 a) { return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z); }

/// A symmetric matrix.
struct symmetric {
  float xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;

  void add_square(vec3 a) {
    xx += a.x * a.x;
    xy += a.x * a.y;
    xz += a.x * a.z;
    yy += a.y * a.y;
    yz += a.y * a.z;
    zz += a.z * a.z;
  }
  symmetric less(float of_diagonal) const { return {xx - of_diagonal, xy, xz, yy - of_diagonal, yz, zz - of_diagonal}; }
  vec3 column(int k) const { return k == 0 ? vec3{xx, xy, xz} : (k == 1 ? vec3{xy, yy, yz} : vec3{xz, yz, zz}); }
};

/// The eigenvalues, ascending, by the roots of the characteristic polynomial. The matrix should have a trace near 0 and
/// a largest entry of 1.
inline void eigenvalues(const symmetric& m, float (&roots)[3]) {
  constexpr float third = 1.0f / 3.0f;
  const float root_of_3 = std::sqrt(3.0f);
  const float c0 =
      m.xx * m.yy * m.zz + 2.0f * m.xy * m.xz * m.yz - m.xx * m.yz * m.yz - m.yy * m.xz * m.xz - m.zz * m.xy * m.xy;
  const float c1 = m.xx * m.yy - m.xy * m.xy + m.xx * m.zz - m.xz * m.xz + m.yy * m.zz - m.yz * m.yz;
  const float c2 = m.xx + m.yy + m.zz;
  const float mean = c2 * third;
  const float a = std::max((c2 * mean - c1) * third, 0.0f);
  const float half_b = 0.5f * (c0 + mean * (2.0f * mean * mean - c1));
  const float q = std::max(a * a * a - half_b * half_b, 0.0f);
  const float rho = std::sqrt(a), theta = std::atan2(std::sqrt(q), half_b) * third;
  const float cosine = std::cos(theta), sine = std::sin(theta);
  roots[0] = mean - rho * (cosine + root_of_3 * sine);
  roots[1] = mean - rho * (cosine - root_of_3 * sine);
  roots[2] = mean + 2.0f * rho * cosine;
}

/// The unit vector that a matrix of rank 2 maps to 0; and a vector across it, a column of the matrix.
struct kernel_of {
  vec3 direction, across;

  explicit kernel_of(const symmetric& m) {
    const float diagonal[3] = {std::abs(m.xx), std::abs(m.yy), std::abs(m.zz)};
    int k = 0;
    for (int i = 1; i < 3; ++i)
      if (diagonal[i] > diagonal[k]) k = i;
    across = m.column(k);
    const vec3 a = plain_cross(across, m.column((k + 1) % 3)), b = plain_cross(across, m.column((k + 2) % 3));
    const float of_a = plain_dot(a, a), of_b = plain_dot(b, b);
    direction = of_a > of_b ? over(a, std::sqrt(of_a)) : over(b, std::sqrt(of_b));
  }
};

/// The unit eigenvector of the largest eigenvalue, in closed form, as Eigen 3.4's `computeDirect` finds it. Not finite
/// if the matrix is not.
inline vec3 largest_axis(const symmetric& m) {
  constexpr float epsilon = std::numeric_limits<float>::epsilon();
  symmetric s = m.less(sum_of(m.xx, m.yy, m.zz) / 3.0f);
  const float scale =
      std::max({std::abs(s.xx), std::abs(s.xy), std::abs(s.xz), std::abs(s.yy), std::abs(s.yz), std::abs(s.zz)});
  if (scale > 0) s = {s.xx / scale, s.xy / scale, s.xz / scale, s.yy / scale, s.yz / scale, s.zz / scale};
  float roots[3];
  eigenvalues(s, roots);
  if (roots[2] - roots[0] <= epsilon) return {0, 0, 1};  // all three are one
  const float above = roots[2] - roots[1], below = roots[1] - roots[0];
  if (above > below) return kernel_of(s.less(roots[2])).direction;
  const kernel_of first(s.less(roots[0]));
  if (!(above <= 2 * epsilon * below)) return kernel_of(s.less(roots[2])).direction;
  // The other two eigenvalues are one: any vector across the first will do.
  const vec3 v = first.across - times(plain_dot(first.direction, first.across), first.across);
  const float square = plain_dot(v, v);
  return square > 0 ? over(v, std::sqrt(square)) : v;
}

}  // namespace clearance::splits

namespace clearance {

/// What a split rule sees of a primitive: its number, and the box around its balls.
struct split_item {
  std::uint32_t id;
  Eigen::Vector3f lower, upper;

  Eigen::Vector3f center() const {
    const vec3 c = plain_center();
    return {c.x, c.y, c.z};
  }
  /// The centre in plain floats, as the rules of this file use it: compilers are slow with operators of Eigen.
  vec3 plain_center() const {
    return {(lower[0] + upper[0]) / 2, (lower[1] + upper[1]) / 2, (lower[2] + upper[2]) / 2};
  }
};

namespace splits {

inline vec3 floats_of(const Eigen::Vector3f& v) { return {v[0], v[1], v[2]}; }
inline Eigen::Vector3f for_eigen(vec3 v) { return {v.x, v.y, v.z}; }
inline vec3 least(vec3 a, vec3 b) { return {min(a.x, b.x), min(a.y, b.y), min(a.z, b.z)}; }
inline vec3 most(vec3 a, vec3 b) { return {max(a.x, b.x), max(a.y, b.y), max(a.z, b.z)}; }
/// The number of the first item whose centre lies beyond `middle` along a way.
inline std::size_t first_beyond(std::span<const split_item> items, vec3 way, float middle) {
  std::size_t k = 0;
  while (k < items.size() && !(plain_dot(items[k].plain_center(), way) > middle)) ++k;
  return k;
}

}  // namespace splits

/// The order of centres along a direction.
struct center_order {
  Eigen::Vector3f direction;
  bool operator()(const split_item& a, const split_item& b) const {
    const vec3 way = splits::floats_of(direction);
    const float x = splits::plain_dot(a.plain_center(), way), y = splits::plain_dot(b.plain_center(), way);
    return x < y || (x == y && a.id < b.id);
  }
};

namespace splits {

inline void halve(std::span<split_item> items, const Eigen::Vector3f& direction) {
  const auto middle = items.begin() + std::ptrdiff_t(items.size() / 2);
  std::nth_element(items.begin(), middle, items.end(), center_order{direction});
}

}  // namespace splits

/// The unit direction in which the centres spread most.
inline Eigen::Vector3f principal_direction(std::span<const split_item> items) {
  vec3 mean{0, 0, 0};
  for (const auto& i : items) mean = mean + splits::over(i.plain_center(), float(items.size()));
  splits::symmetric covariance;
  for (const auto& i : items) covariance.add_square(i.plain_center() - mean);
  vec3 principal = splits::largest_axis(covariance);
  if (!splits::all_finite(principal) || !(splits::plain_length(principal) > 0.5f)) principal = {1, 0, 0};
  return splits::for_eigen(principal);
}

/// Split rule: the middle along the widest axis. Gives the least depth.
struct median_split {
  std::size_t operator()(std::span<split_item> items) const {
    vec3 lo = items[0].plain_center(), hi = lo;
    for (const auto& i : items) {
      lo = splits::least(lo, i.plain_center());
      hi = splits::most(hi, i.plain_center());
    }
    const vec3 wide = hi - lo;
    // Products by 0 and 1 keep the order of coordinates, so one selection serves this rule and the next.
    const int axis = wide.y > wide.x ? (wide.z > wide.y ? 2 : 1) : (wide.z > wide.x ? 2 : 0);
    splits::halve(items, {axis == 0 ? 1.0f : 0.0f, axis == 1 ? 1.0f : 0.0f, axis == 2 ? 1.0f : 0.0f});
    return items.size() / 2;
  }
};

/// Split rule: the middle along the direction in which the centres spread most.
struct principal_split {
  std::size_t operator()(std::span<split_item> items) const {
    splits::halve(items, principal_direction(items));
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
      const vec3 near = mean(items.first(cut)), far = mean(items.subspan(cut)), way = far - near;
      if (!(splits::plain_length(way) > 0)) break;
      std::sort(items.begin(), items.end(), center_order{splits::for_eigen(way)});
      const float middle = splits::plain_dot(near + far, way) / 2;
      const auto now = std::clamp(splits::first_beyond(items, way, middle), least, n - least);
      if (now == cut && round > 0) break;
      cut = now;
    }
    return cut;
  }

 private:
  static vec3 mean(std::span<const split_item> items) {
    vec3 sum{0, 0, 0};
    for (const auto& i : items) sum = sum + i.plain_center();
    return splits::over(sum, float(items.size()));
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
    std::array<vec3, 2> mean = {items[n / 4].plain_center(), items[n - 1 - n / 4].plain_center()};

    for (int round = 0; round < rounds; ++round) {
      const float width =
          std::pow(0.01f, float(round) / (rounds - 1));  // of the neighbourhood: shrinks from one rank to a hundredth
      const std::array<float, 2> pull = {1, std::exp(-1 / width)};
      std::array<vec3, 2> sum = {};
      std::array<float, 2> weight = {0, 0};

      for (const auto& i : items) {
        const vec3 c = i.plain_center(), to_0 = c - mean[0], to_1 = c - mean[1];
        const std::size_t near = splits::plain_dot(to_1, to_1) < splits::plain_dot(to_0, to_0);
        const float volume = (i.upper[0] - i.lower[0]) * ((i.upper[1] - i.lower[1]) * (i.upper[2] - i.lower[2]));
        for (const std::size_t k : {near, 1 - near}) {
          const float by = pull[k != near] * volume;
          sum[k] = sum[k] + splits::times(by, c);
          weight[k] += by;
        }
      }
      for (std::size_t k = 0; k < 2; ++k)
        if (weight[k] > 0 && splits::all_finite(sum[k])) mean[k] = splits::over(sum[k], weight[k]);
    }

    vec3 way = mean[1] - mean[0];
    if (!(splits::plain_length(way) > 0) || !splits::all_finite(way)) way = splits::floats_of(principal);
    std::sort(items.begin(), items.end(), center_order{splits::for_eigen(way)});
    const float middle = splits::plain_dot(mean[0] + mean[1], way) / 2;
    return std::clamp(splits::first_beyond(items, way, middle), least, n - least);
  }
};

/// Split rule: the cut with the least surface-area cost (Goldsmith & Salmon 1987), along one of the three axes or the
/// principal one. Neither side gets less than a third, so that the depth stays logarithmic. The default.
struct surface_area_split {
  std::size_t operator()(std::span<split_item> items) const {
    const std::size_t n = items.size(), least = std::max<std::size_t>(1, n / 3);
    float best = std::numeric_limits<float>::infinity();
    Eigen::Vector3f best_direction{1, 0, 0};
    std::size_t cut = n / 2;
    std::vector<float> left(n);
    for (const Eigen::Vector3f& direction : directions(items)) {
      std::sort(items.begin(), items.end(), center_order{direction});
      sweep(items.begin(), items.end(), left.begin());
      std::vector<float> right(n);
      sweep(items.rbegin(), items.rend(), right.begin());
      for (std::size_t k = least; k + least <= n; ++k) {
        const float cost = float(k) * left[k - 1] + float(n - k) * right[n - k - 1];
        if (cost < best) {
          best = cost;
          cut = k;
          best_direction = direction;
        }
      }
    }
    std::sort(items.begin(), items.end(), center_order{best_direction});
    return cut;
  }

 private:
  template <class In, class Out>
  static void sweep(In first, In last, Out area) {
    vec3 lo = splits::floats_of(first->lower), hi = splits::floats_of(first->upper);
    for (; first != last; ++first, ++area) {
      lo = splits::least(lo, splits::floats_of(first->lower));
      hi = splits::most(hi, splits::floats_of(first->upper));
      const vec3 d = hi - lo;
      *area = d.x * d.y + d.y * d.z + d.z * d.x;
    }
  }
  static std::array<Eigen::Vector3f, 4> directions(std::span<const split_item> items) {
    return {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, principal_direction(items)}};
  }
};

}  // namespace clearance
