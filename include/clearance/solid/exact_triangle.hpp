// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Exact distances to a triangle, for what must be proven about solids.

#include <clearance/ground/vectors.hpp>
#include <clearance/solid/eight.hpp>
#include <clearance/solid/vec3d.hpp>

#include <Eigen/Geometry>

#include <algorithm>

namespace clearance {

/// Distances to one triangle in double, exact to rounding even on slivers and degenerate triangles. Made on the host.
class exact_triangle {
 public:
  exact_triangle(const vec3d& a, const vec3d& b, const vec3d& c) : v_{a, b, c} {
    const vec3d n = (b - a).cross(c - a);
    const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
    // On a thinner triangle the normal loses digits; its edges alone are then right to 1e-8 of an edge.
    if (n.norm() > 1e-8 * longest * longest) normal_ = (1 / n.norm()) * n;
    for (int k = 0; k < 3; ++k) {
      const vec3d edge = v_[(k + 1) % 3] - v_[k];
      inward_[k] = normal_.cross(edge);
      per_square_[k] = edge.dot(edge) > 0 ? 1 / edge.dot(edge) : 0;
      if (!std::isfinite(per_square_[k])) per_square_[k] = 0;
    }
    well_shaped_ = n.norm() > 1e-3 * longest * longest;
  }

  /// The distance if it is below `best`, else `best`.
  CLEARANCE_HD double nearer(const vec3d& p, double best) const {
    const vec3d q[3] = {p - v_[0], p - v_[1], p - v_[2]};
    const double height = ::fabs(normal_.dot(q[0]));
    if (well_shaped_ && height >= best) return best;
    bool beyond[3], above = true;
    for (int k = 0; k < 3; ++k) above = !(beyond[k] = !(inward_[k].dot(q[k]) > 0)) && above;
    if (above) {
      if (height < best) best = height;
      if (well_shaped_) return best;
    }
    double least = best * best;
    for (int k = 0; k < 3; ++k) {
      if (well_shaped_ && !beyond[k]) continue;  // the nearest point is on a side that the projection is beyond
      const vec3d edge = v_[(k + 1) % 3] - v_[k];
      const double along = q[k].dot(edge) * per_square_[k], t = along < 0 ? 0 : along > 1 ? 1 : along;
      const vec3d way = q[k] - t * edge;
      if (way.dot(way) < least) least = way.dot(way);
    }
    return least < best * best ? ::sqrt(least) : best;
  }

  /// The same for eight places side by side, whose distances so far are `best`; no branch depends on a place.
  void nearer(const eighths& p, eight& best) const {
    with_wide_vectors([&] { lower(p, best); });
  }

  Eigen::Vector3d corner(int k) const { return v_[k]; }
  Eigen::AlignedBox3d box() const {
    Eigen::AlignedBox3d b(corner(0));
    return b.extend(corner(1)).extend(corner(2));
  }
  double area() const { return (v_[1] - v_[0]).cross(v_[2] - v_[0]).norm() / 2; }

 private:
  void lower(const eighths& p, eight& best) const {
    eight height;
    std::int64_t near = 0;
    for (int j = 0; j < 8; ++j) {
      height.v[j] = std::fabs(normal_.dot(p[j] - v_[0]));
      near |= height.v[j] < best.v[j] ? 1 : 0;
    }
    if (well_shaped_ && near == 0) return;
    std::int64_t beyond = 0;
    for (int j = 0; j < 8; ++j) {
      const double a = inward_[0].dot(p[j] - v_[0]), b = inward_[1].dot(p[j] - v_[1]), c = inward_[2].dot(p[j] - v_[2]);
      const bool above = (a > 0) & (b > 0) & (c > 0);
      best.v[j] = (above & (height.v[j] < best.v[j])) ? height.v[j] : best.v[j];
      beyond |= above ? 0 : 1;
    }
    if (well_shaped_ && beyond == 0) return;
    eight least = eight::of(double(infinity));
    to_edge<0>(p, least);
    to_edge<1>(p, least);
    to_edge<2>(p, least);
    take_roots(least);
    for (int j = 0; j < 8; ++j) best.v[j] = least.v[j] < best.v[j] ? least.v[j] : best.v[j];
  }

  /// Lowers the squared distances of those places that side K is nearest to, if any is. (Three calls: compilers unroll
  /// loops within a loop instead of making vectors of them. A loop that chooses is one of its own: else it branches.)
  template <int K>
  void to_edge(const eighths& p, eight& least) const {
    const vec3d corner = v_[K], edge = v_[(K + 1) % 3] - corner;
    const vec3d inward = (well_shaped_ ? 1.0 : 0.0) * inward_[K];  // 0: every side counts
    const double per_square = per_square_[K];
    eight along, side, square;
    for (int j = 0; j < 8; ++j) {
      const vec3d q = p[j] - corner;
      along.v[j] = q.dot(edge) * per_square;
      side.v[j] = inward.dot(q);
    }
    for (double& t : along.v) t = t > 0 ? t : 0;
    for (double& t : along.v) t = t < 1 ? t : 1;
    for (int j = 0; j < 8; ++j) {
      const vec3d way = p[j] - corner - along.v[j] * edge;
      square.v[j] = way.dot(way);
    }
    for (int j = 0; j < 8; ++j) least.v[j] = (!(side.v[j] > 0) & (square.v[j] < least.v[j])) ? square.v[j] : least.v[j];
  }

  vec3d v_[3], normal_, inward_[3];
  double per_square_[3];
  bool well_shaped_ = false;
};

}  // namespace clearance
