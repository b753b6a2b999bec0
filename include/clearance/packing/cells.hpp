// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/solid/solid.hpp>

#include <tbb/parallel_for.h>

#include <cmath>

namespace clearance {

/// A cube of space, and the solid's signed distance at its middle, positive inside.
struct solid_cell {
  Eigen::Vector3d middle;
  double half;
  double depth;

  double reach() const { return half * 1.7320508075688774; }  ///< From the middle to a corner, rounded up.
};

template <class S>
double distance_within(const S& s, const Eigen::Vector3d& p, double within) {
  if constexpr (requires { { s.distance(p, within) } -> std::same_as<double>; })
    return s.distance(p, within);
  else
    return s.distance(p);
}

/// Cubes of one size that cover the bounds, about `along` in a row of the longest side.
template <solid S>
std::vector<solid_cell> cover(const S& s, int along, const Eigen::Vector3d& shift = Eigen::Vector3d::Zero()) {
  const Eigen::AlignedBox3d box = s.bounds();
  const double half = box.sizes().maxCoeff() / (2 * along);
  Eigen::Vector3i count;
  for (int k = 0; k < 3; ++k) count[k] = int(std::ceil(box.sizes()[k] / (2 * half) + std::abs(shift[k]) + 1e-6));
  const Eigen::Vector3d low = box.center() - half * count.cast<double>() + half * shift;
  std::vector<solid_cell> cells(std::size_t(count.x()) * count.y() * count.z());
  tbb::parallel_for(std::size_t(0), cells.size(), [&](std::size_t i) {
    const Eigen::Vector3d at(double(i % count.x()), double(i / count.x() % count.y()), double(i / count.x() / count.y()));
    const Eigen::Vector3d p = low + half * (2 * at + Eigen::Vector3d::Ones());
    const double d = s.distance(p);
    cells[i] = {p, half, s.inside(p) ? d : -d};
  });
  return cells;
}

/// The k-th eighth of a cell.
template <solid S>
solid_cell eighth(const S& s, const solid_cell& parent, int k) {
  solid_cell c;
  c.half = parent.half / 2;
  c.middle = parent.middle + c.half * Eigen::Vector3d(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1);
  const double step = c.reach(), known = std::abs(parent.depth);
  const double d = distance_within(s, c.middle, (known + step) * (1 + 1e-12));
  // No surface lies within `known` of the parent's middle.
  const bool inside = known > step * (1 + 1e-9) ? parent.depth > 0 : s.inside(c.middle);
  c.depth = inside ? d : -d;
  return c;
}

}  // namespace clearance
