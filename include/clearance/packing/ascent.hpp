// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/packing/cells.hpp>
#include <clearance/packing/compass.hpp>
#include <clearance/packing/sphere_field.hpp>

#include <optional>

namespace clearance {

/// Free room around a place, from a few triangles and spheres: distance to the surface and to the spheres, exact while
/// it is below `reach` minus the way from the place, and never too large.
template <solid S>
class local_room {
 public:
  local_room(const S& s, const sphere_field& spheres, const Eigen::Vector3d& place, double reach)
      : solid_(near(s, place, reach)), place_(place), reach_(reach) {
    for (const std::uint32_t i : spheres.within(place, reach))
      spheres_.push_back({spheres[i].center, spheres[i].radius});
  }
  /// Anything not above `least` if it is not.
  double operator()(const Eigen::Vector3d& p, double within, double least) const {
    double d = std::min(within, reach_ - (p - place_).norm());
    for (const auto& s : spheres_)
      if (d > least) d = s.nearer(p, d);
    return d > least ? distance_within(solid_, p, d) : d;
  }
  /// Is it of use from here on, for steps as long as the sphere's radius?
  bool serves(const solid_sphere& now) const {
    return reach_ >= 2 * now.radius && (Eigen::Vector3d(now.center) - place_).norm() <= 0.2 * reach_;
  }

 private:
  static auto near(const S& s, const Eigen::Vector3d& place, double reach) {
    if constexpr (requires { s.near(place, reach).distance(place); }) {
      return s.near(place, reach);
    } else {
      struct whole {
        const S* s;
        double distance(const Eigen::Vector3d& p, double within) const { return distance_within(*s, p, within); }
      };
      return whole{&s};
    }
  }

  decltype(near(std::declval<const S&>(), Eigen::Vector3d{}, 0.0)) solid_;
  std::vector<solid_sphere> spheres_;
  Eigen::Vector3d place_;
  double reach_;
};

/// Climbs from an inside point with room `radius` to a local maximum of the room, by compass search. Every step stays
/// in the ball that is known to be inside, so no step can leave the solid through a thin wall.
template <solid S>
sphere_field::sphere ascend(const S& s, const sphere_field& spheres, const Eigen::Vector3d& from, double radius,
                            double farthest = std::numeric_limits<double>::infinity(), double precision = 1e-3) {
  std::optional<local_room<S>> room;
  const auto prepare = [&](const solid_sphere& now) {
    if (!room || !room->serves(now)) room.emplace(s, spheres, now.center, 2.5 * now.radius);
  };
  const solid_sphere top = compass_search(solid_sphere{from, radius}, precision, one_lane{}, prepare,
                                  [&](const Eigen::Vector3d& p, double most, double least) {
                                    return (p - from).norm() > farthest ? 0 : (*room)(p, most * (1 + 1e-12), least);
                                  });
  return {top.center, top.radius};
}

/// Moves and grows an inside sphere, whatever spheres are in the way, while it covers the middle of what it was.
template <solid S>
sphere_field::sphere grow(const S& s, const sphere_field::sphere& from) {
  const solid_sphere top = compass_search(
      solid_sphere{from.center, from.radius}, 1e-2, one_lane{}, [](const solid_sphere&) {},
      [&](const Eigen::Vector3d& p, double most, double) {
        const double r = distance_within(s, p, most * (1 + 1e-12));
        return (p - from.center).norm() <= r - from.radius / 2 ? r : 0;
      });
  return {top.center, top.radius};
}

}  // namespace clearance
