// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A part's spheres as files of any format hold them.

#include <clearance/io/digest.hpp>
#include <clearance/packing/packing.hpp>

#include <algorithm>
#include <charconv>
#include <limits>

namespace clearance::io {

/// One part of a robot, as a file of spheres holds it.
struct packed_part {
  std::string name;      ///< The link; may be empty.
  packing spheres;       ///< In the part's frame. Without a certificate the gap is infinite.
  double tolerance = 0;  ///< How far the packed mesh may differ from the true surface, metres (tessellation). If read
                         ///< from a file, it includes the spheres' own tolerance.
  digest solid;          ///< Digest of the certified mesh.
  digest recipe;         ///< Digest of that mesh and the options of `pack`; see packing_key.
};

/// A packing of which only the spheres are known, in the order given.
inline packing uncertified(std::vector<inner_sphere> spheres) {
  constexpr double unknown = std::numeric_limits<double>::infinity();
  packing made;
  made.gap = made.gap_mean = made.gap_p95 = made.room = unknown;
  if (!spheres.empty()) {
    const auto [least, most] = std::minmax_element(spheres.begin(), spheres.end(),
                                                   [](const auto& a, const auto& b) { return a.radius < b.radius; });
    made.radius_min = least->radius, made.radius_max = most->radius;
  }
  made.spheres = std::move(spheres);
  return made;
}

/// Returns the sphere, or refuses it: it must be finite, up to 1e18 m, with a radius above 0.
inline inner_sphere checked_sphere(vec3 center, real radius, const std::string& file, const std::string& which,
                                   std::size_t line = 0) {
  if (!is_finite(center)) refuse(file, which + " has a centre that is not finite", line);
  if (!(radius > 0) || !is_finite(radius))
    refuse(file, which + " has a radius of " + std::to_string(radius) + " m", line);
  return {center, radius};
}

/// The fewest digits that restore the float exactly, whatever the locale.
inline std::string shortest(float value) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

}  // namespace clearance::io
