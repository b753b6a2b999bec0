// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/packing/cells.hpp>
#include <clearance/packing/sphere_field.hpp>

namespace clearance {

/// Free room around a place, from a few triangles and spheres: distance to the surface and to the spheres, exact while it
/// is below `reach` minus the way from the place, and never too large.
template <solid S>
class local_room {
 public:
  local_room(const S& s, const sphere_field& spheres, const Eigen::Vector3d& place, double reach)
      : solid_(near(s, place, reach)), place_(place), reach_(reach) {
    for (const std::uint32_t i : spheres.within(place, reach)) spheres_.push_back(spheres[i]);
  }
  double operator()(const Eigen::Vector3d& p) const {
    double d = std::min(solid_.distance(p), reach_ - (p - place_).norm());
    for (const auto& s : spheres_) d = std::min(d, s.distance(p));
    return d;
  }

 private:
  static auto near(const S& s, const Eigen::Vector3d& place, double reach) {
    if constexpr (requires { s.near(place, reach).distance(place); }) {
      return s.near(place, reach);
    } else {
      struct whole {
        const S* s;
        double distance(const Eigen::Vector3d& p) const { return s->distance(p); }
      };
      return whole{&s};
    }
  }

  decltype(near(std::declval<const S&>(), Eigen::Vector3d{}, 0.0)) solid_;
  std::vector<sphere_field::sphere> spheres_;
  Eigen::Vector3d place_;
  double reach_;
};

/// Climbs from an inside point with room `radius` to a local maximum of the room, by compass search. Every step stays in
/// the ball that is known to be inside, so no step can leave the solid through a thin wall.
template <solid S>
sphere_field::sphere ascend(const S& s, const sphere_field& spheres, Eigen::Vector3d at, double radius,
                            double farthest = std::numeric_limits<double>::infinity(), double precision = 1e-3) {
  const Eigen::Vector3d from = at;
  double step = radius / 2;
  for (int round = 0; round < 8; ++round) {
    const Eigen::Vector3d start = at;
    const double reach = 2.5 * radius;
    const local_room<S> room(s, spheres, at, reach);
    radius = room(at);
    Eigen::Vector3d last = Eigen::Vector3d::Zero();
    while (step > precision * radius && (at - start).norm() < 0.5 * reach) {
      Eigen::Vector3d best = at;
      double best_radius = radius;
      const auto attempt = [&](const Eigen::Vector3d& by) {
        const Eigen::Vector3d p = at + by;
        if ((p - from).norm() > farthest) return;
        const double r = room(p);
        if (r > best_radius) best = p, best_radius = r;
      };
      if (last != Eigen::Vector3d::Zero()) attempt(last);
      if (best_radius <= radius + 0.02 * step)
        for (int k = 0; k < 6; ++k) attempt((k & 1 ? step : -step) * Eigen::Vector3d::Unit(k / 2));
      if (best_radius > radius + 0.02 * step) {  // less is not worth a step of this size
        last = best - at;
        at = best, radius = best_radius;
        step = std::min(step, 0.9 * radius);
      } else {
        step /= 2;
        last.setZero();
      }
    }
    if (step <= precision * radius) break;
  }
  return {at, radius};
}

/// Moves and grows an inside sphere, whatever spheres are in the way, while it covers the middle of what it was.
template <solid S>
sphere_field::sphere grow(const S& s, const sphere_field::sphere& from) {
  sphere_field::sphere now = from;
  for (double step = from.radius / 2; step > 1e-2 * from.radius;) {
    sphere_field::sphere best = now;
    for (int k = 0; k < 6; ++k) {
      const Eigen::Vector3d p = now.center + (k & 1 ? step : -step) * Eigen::Vector3d::Unit(k / 2);
      const double r = distance_within(s, p, now.radius + 2 * step);
      if (r > best.radius && (p - from.center).norm() <= r - from.radius / 2) best = {p, r};
    }
    if (best.radius > now.radius + 0.02 * step)
      now = best, step = std::min(2 * step, 0.9 * now.radius);
    else
      step /= 2;
  }
  return now;
}

}  // namespace clearance
