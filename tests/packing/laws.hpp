// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "solid/shapes.hpp"
#include "support/catch.hpp"

#include <clearance/packing/packing.hpp>
#include <clearance/solid/mesh_solid.hpp>

#include <random>

/// Checks what holds for every packing, whoever made it.
namespace packing_laws {

using namespace clearance;
using Eigen::Vector3d;

inline double gap_between(const inner_sphere& a, const inner_sphere& b) {
  const Vector3d d(double(a.center.x) - b.center.x, double(a.center.y) - b.center.y, double(a.center.z) - b.center.z);
  return d.norm() - (double(a.radius) + b.radius);
}

inline double sphere_distance(const packing& p, const Vector3d& at) {
  double best = std::numeric_limits<double>::infinity();
  for (const inner_sphere& s : p.spheres)
    best = std::min(best, (at - Vector3d(s.center.x, s.center.y, s.center.z)).norm() - s.radius);
  return best;
}

/// Every law of a packing, by brute force in double. Distances are asked of each triangle by itself.
inline void check_laws(const triangle_mesh& mesh, const packing& p, int points = 2000, bool overlap = false) {
  const mesh_solid s(mesh);
  std::vector<exact_triangle> triangles;
  for (const auto& t : s.mesh().surface.triangles)
    triangles.emplace_back(s.corners()[t[0]], s.corners()[t[1]], s.corners()[t[2]]);
  const auto to_surface = [&](const Vector3d& at) {
    double best = std::numeric_limits<double>::infinity();
    for (const auto& t : triangles) best = t.nearer(at, best);
    return best;
  };
  REQUIRE(!p.spheres.empty());
  int outside = 0, poking = 0, overlapping = 0, disordered = 0;
  for (std::size_t i = 0; i < p.spheres.size(); ++i) {
    const inner_sphere& a = p.spheres[i];
    const Vector3d c(a.center.x, a.center.y, a.center.z);
    outside += !s.inside(c);
    poking += !(a.radius > 0 && to_surface(c) >= double(a.radius));
    disordered += i > 0 && p.spheres[i - 1].radius < a.radius;
    if (!overlap)
      for (std::size_t j = 0; j < i; ++j) overlapping += gap_between(a, p.spheres[j]) < 0;
  }
  CHECK(outside == 0);
  CHECK(poking == 0);
  CHECK(overlapping == 0);
  CHECK(disordered == 0);
  CHECK(p.radius_max == p.spheres.front().radius);
  CHECK(p.radius_min == p.spheres.back().radius);
  CHECK((overlap || (p.fill > 0 && p.fill <= 1.001 * (s.overlaps() ? 1.01 : 1))));

  // The certificate: the exact distance to the solid, 0 inside, is in [d - gap, d], and not above 0 if d is not.
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(0, 1);
  int broken = 0, roomier = 0;  // places with more room than there is said to be
  const auto law = [&](const Vector3d& at, double exact) {
    const double d = sphere_distance(p, at);
    broken += !(exact >= std::max(0.0, d - p.gap) && exact <= std::max(0.0, d));
  };
  for (int i = 0; i < points; ++i) {
    const Vector3d u(unit(random), unit(random), unit(random));
    const Vector3d at = s.bounds().min() + (1.5 * u - Vector3d::Constant(0.25)).cwiseProduct(s.bounds().sizes());
    law(at, s.inside(at) ? 0 : to_surface(at));
    roomier += s.inside(at) && std::min(to_surface(at), sphere_distance(p, at)) > p.room;
  }
  for (const Vector3d& at : s.surface_points(std::size_t(points))) law(at, 0);
  for (const Vector3d& at : s.corners()) law(at, 0);
  CHECK(broken == 0);
  CHECK(roomier == 0);
  CHECK(p.gap_mean <= p.gap_p95 + p.gap);
  CHECK(p.gap_p95 <= p.gap);
}

/// A lower bound of the gap, from many points of the solid.
inline double met_gap(const mesh_solid& s, const packing& p) {
  double most = 0;
  for (const auto& at : s.corners()) most = std::max(most, sphere_distance(p, at));
  for (const auto& at : s.surface_points(20000)) most = std::max(most, sphere_distance(p, at));
  for (const auto& t : s.mesh().surface.triangles)  // gaps are largest at edges
    for (int k = 0; k < 3; ++k)
      for (int i = 1; i < 256; ++i)
        most = std::max(most, sphere_distance(p, s.corners()[t[k]] +
                                                     i / 256.0 * (s.corners()[t[(k + 1) % 3]] - s.corners()[t[k]])));
  return most;
}

/// A torus as a formula: any solid that says where it can be asked is packed there.
struct ring {
  struct view_type {
    CLEARANCE_HD static double signed_distance(const vec3d& p) {
      const double across = ::sqrt(p.x * p.x + p.y * p.y) - 1;
      return ::sqrt(across * across + p.z * p.z) - 0.25;
    }
    CLEARANCE_HD double distance(const vec3d& p, double within, double) const {
      const double d = ::fabs(signed_distance(p));
      return d < within ? d : within;
    }
    CLEARANCE_HD bool inside(const vec3d& p) const { return signed_distance(p) < 0; }
  };
  Eigen::AlignedBox3d bounds() const { return {Vector3d(-1.25, -1.25, -0.25), Vector3d(1.25, 1.25, 0.25)}; }
  double distance(const Vector3d& p) const { return std::abs(view_type::signed_distance(p)); }
  bool inside(const Vector3d& p) const { return view_type::signed_distance(p) < 0; }

  view_type view() const { return {}; }
  template <backend B>
  ring on(const B&) const {
    return {};
  }
};

/// The laws, of 200 spheres in a ring.
inline void check_ring(const packing& p) {
  CHECK(p.spheres.size() == 200);
  CHECK(p.radius_max == Approx(0.25).epsilon(1e-3));
  const auto signed_distance = [](const Vector3d& at) { return ring::view_type::signed_distance(at); };
  int outside = 0, overlapping = 0, broken = 0;
  for (std::size_t i = 0; i < p.spheres.size(); ++i) {
    const auto& [c, r] = p.spheres[i];
    outside += signed_distance({c.x, c.y, c.z}) > -double(r);
    for (std::size_t j = 0; j < i; ++j) overlapping += gap_between(p.spheres[i], p.spheres[j]) < 0;
  }
  CHECK(outside == 0);
  CHECK(overlapping == 0);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(-1.5, 1.5);
  for (int i = 0; i < 20000; ++i) {
    const Vector3d at(unit(random), unit(random), unit(random) / 4);
    const double exact = std::max(0.0, signed_distance(at)), d = sphere_distance(p, at);
    broken += !(exact >= std::max(0.0, d - p.gap) && exact <= std::max(0.0, d));
  }
  CHECK(broken == 0);
}

inline bool same(const packing& a, const packing& b) {
  if (a.spheres.size() != b.spheres.size()) return false;
  for (std::size_t i = 0; i < a.spheres.size(); ++i)
    if (!(a.spheres[i].center == b.spheres[i].center && a.spheres[i].radius == b.spheres[i].radius)) return false;
  return a.gap == b.gap && a.gap_mean == b.gap_mean && a.gap_p95 == b.gap_p95 && a.fill == b.fill && a.room == b.room;
}

}  // namespace packing_laws
