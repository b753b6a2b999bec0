// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The cubes in which packing searches a solid, and how deep in it their middles are.

#include <clearance/solid/eight.hpp>
#include <clearance/solid/solid.hpp>

namespace clearance {

/// Half of a cube's diagonal, rounded up.
CLEARANCE_HD constexpr double corner_reach(double half) { return half * 1.7320508075688774; }

CLEARANCE_HD inline vec3d eighth_middle(const vec3d& middle, double half, std::uint32_t k) {
  const double h = half / 2;
  return middle + vec3d(k & 1 ? h : -h, k & 2 ? h : -h, k & 4 ? h : -h);
}

/// May the inside end where no surface is, as at a passage that a flood takes for a wall?
template <solid_view V>
CLEARANCE_HD bool is_porous(const V& in) {
  if constexpr (requires {
                  { in.porous() } -> std::same_as<bool>;
                })
    return in.porous();
  else
    return false;
}

/// The signed distance, positive inside. It differs by at most `step` from `known`, that of another place, which is 0
/// if unknown. No surface is within |known| of that place.
CLEARANCE_CALLS_ANYTHING
template <solid_view V>
CLEARANCE_HD double signed_depth(const V& in, const vec3d& p, double known, double step) {
  const double free = known < 0 ? -known : known;
  const double within = free > 0 ? (free + step) * (1 + 1e-12) : double(infinity);
  const bool inside = free > step * (1 + 1e-9) && !is_porous(in) ? known > 0 : in.inside(p);
  const double d = in.distance(p, within, 0);
  return inside ? d : -d;
}

/// The same for a cube's eighths, all at once on the host: `known` is that of the cube's middle, and `step` the way
/// there. Asked only where `to` is not 0; it stays 0 elsewhere.
template <solid_view V>
void signed_depths(const V& in, const eighths& p, double known, double step, eight& to) {
  const double free = known < 0 ? -known : known;
  const double within = free > 0 ? (free + step) * (1 + 1e-12) : double(infinity);
  const bool one_side = free > step * (1 + 1e-9) && !is_porous(in);
  eight d;
  for (int k = 0; k < 8; ++k) d.v[k] = to.v[k] != 0 ? within : -double(infinity);
  if constexpr (requires { in.distances(p, d); })
    in.distances(p, d);
  else
    for (int k = 0; k < 8; ++k)
      if (to.v[k] != 0) d.v[k] = in.distance(p[k], within, 0);
  for (int k = 0; k < 8; ++k)
    if (to.v[k] != 0) to.v[k] = (one_side ? known > 0 : in.inside(p[k])) ? d.v[k] : -d.v[k];
}

/// Cubes of one size that cover a box, about `along` of them along its longest side.
struct cube_grid {
  vec3d low;
  double half;
  std::uint32_t count[3];

  cube_grid(const Eigen::AlignedBox3d& box, int along, const Eigen::Vector3d& shift = Eigen::Vector3d::Zero())
      : half(box.sizes().maxCoeff() / (2 * along)) {
    Eigen::Vector3d size;
    for (int k = 0; k < 3; ++k) {
      count[k] = std::uint32_t(std::ceil(box.sizes()[k] / (2 * half) + std::abs(shift[k]) + 1e-6));
      size[k] = count[k];
    }
    low = Eigen::Vector3d(box.center() - half * size + half * shift);
  }
  std::size_t size() const { return std::size_t(count[0]) * count[1] * count[2]; }
  CLEARANCE_HD vec3d middle(std::size_t i) const {
    const std::size_t row = i / count[0];
    return low +
           half * vec3d(2 * double(i % count[0]) + 1, 2 * double(row % count[1]) + 1, 2 * double(row / count[1]) + 1);
  }
};

}  // namespace clearance
