// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/io/packed_part.hpp>

#include <clearance/io/error.hpp>

#include <clearance/io/digest.hpp>
#include <clearance/packing/packing.hpp>

#include <algorithm>
#include <charconv>
#include <limits>

namespace clearance::io {

packing uncertified(std::vector<inner_sphere> spheres) {
  constexpr double unknown = std::numeric_limits<double>::infinity();
  packing made;
  made.gap = made.gap_mean = made.gap_p95 = made.room = unknown;
  if (!spheres.empty()) {
    const auto [least, most] = std::minmax_element(spheres.begin(), spheres.end(),
                                                   [](const auto& a, const auto& b) { return a.radius < b.radius; });
    made.radius_min = least->radius;
    made.radius_max = most->radius;
  }
  made.spheres = std::move(spheres);
  return made;
}

inner_sphere checked_sphere(vec3 center, real radius, const std::string& file, const std::string& which,
                            std::size_t line) {
  if (!is_finite(center)) refuse(file, which + " has a centre that is not finite", line);
  if (!(radius > 0) || !is_finite(radius))
    refuse(file, which + " has a radius of " + std::to_string(radius) + " m", line);
  return {center, radius};
}

std::string shortest(float value) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

}  // namespace clearance::io
