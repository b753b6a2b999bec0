// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace clearance {

/// What can be packed: anything that knows its bounds, its distance, and its inside. Metres, in double; const members
/// are called from several threads at once.
///
/// Law: `bounds()` contains the solid.
/// Law: `distance(p)` is not negative, at most the distance from p to the surface, inside and outside alike, and
/// differs
///      between two points by at most their distance.
/// Law: `inside(p)` is the same for all points that no surface separates.
///
/// Optional: `tolerance()`, metres from the surface within which `inside` may be wrong; `volume()` in cubic metres, for
/// the fill ratio; `surface_points(count)`, evenly spread over the surface, for mean gaps; `corners()`, where gaps tend
/// to be largest; `distance(p, within)`, quicker where a larger distance than `within` need not be known; `view()`, a
/// `solid_view` to ask instead; `on(backend)`, to be packed elsewhere than on a host.
template <class S>
concept solid = requires(const S s, Eigen::Vector3d p) {
  { s.bounds() } -> std::convertible_to<Eigen::AlignedBox3d>;
  { s.distance(p) } -> std::same_as<double>;
  { s.inside(p) } -> std::same_as<bool>;
};

}  // namespace clearance
