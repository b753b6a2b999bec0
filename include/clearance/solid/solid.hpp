// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace clearance {

/// What can be packed: anything that knows its bounds, its distance and its inside. Metres, in double. Several threads
/// call const members at once.
///
/// Law: `bounds()` contains the solid.
/// Law: `distance(p)` is not negative, and at most the distance from p to the surface, inside and outside alike.
/// Between two points it differs by at most their distance.
/// Law: `inside(p)` is the same for all points that no surface separates.
///
/// Optional: `tolerance()`, metres from the surface within which `inside` may be wrong; `volume()` in cubic metres, for
/// the fill ratio; `surface_points(count)`, evenly spread over the surface, for mean gaps; `corners()`, where gaps tend
/// to be largest; `distance(p, within)`, faster if distances above `within` do not matter; `view()`, a `solid_view` to
/// use instead; `on(backend)`, to pack elsewhere than on a host.
template <class S>
concept solid = requires(const S s, Eigen::Vector3d p) {
  { s.bounds() } -> std::convertible_to<Eigen::AlignedBox3d>;
  { s.distance(p) } -> std::same_as<double>;
  { s.inside(p) } -> std::same_as<bool>;
};

}  // namespace clearance
