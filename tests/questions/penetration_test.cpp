// SPDX-License-Identifier: BSD-3-Clause
// A negative distance to inner spheres is how deep the deepest point is in some sphere. It is never more than the exact
// depth; equal at the centre of a sphere that touches the surface; less wherever the spheres leave room.
#include "solid/shapes.hpp"
#include "support/laws.hpp"
#include "support/random.hpp"

#include <clearance/make_model.hpp>
#include <clearance/packing/pack.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/robot/model.hpp>
#include <clearance/solid/mesh_solid.hpp>
#include <clearance/volume/sphere.hpp>

namespace penetration_test {

using namespace testing;
using Eigen::Vector3d;

namespace {

/// Depth in a convex polyhedron: the least distance to the planes of its faces. Shares nothing with the library.
double depth(const clearance::triangle_mesh& convex, const Vector3d& at) {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& t : convex.triangles) {
    const Vector3d &a = convex.vertices[t[0]], n = (convex.vertices[t[1]] - a).cross(convex.vertices[t[2]] - a);
    if (n.norm() > 1e-12) least = std::min(least, (a - at).dot(n.normalized()));
  }
  return least;  // negative outside
}

double ask(const clearance::packing& p, const std::vector<vec3>& points) {
  const auto part = clearance::make_part<clearance::sphere>(p);
  const auto r =
      clearance::ask(clearance::host{}, part, Eigen::Isometry3d::Identity(), points, clearance::min_distance{});
  CHECK(r.lower == 0);
  CHECK((r.distance < -1e-5f ? r.state == clearance::state::collision : true));
  return r.distance;
}

}  // namespace

TEST_CASE("The distance of points inside is the deepest in any sphere, and never deeper than the exact depth") {
  dice d(3);
  const std::pair<const char*, clearance::triangle_mesh> convex[] = {{"cube", shapes::box({0, 0, 0}, {1, 1, 1})},
                                                                     {"plate", shapes::box({-1, -2, 0}, {1, 2, 0.1})},
                                                                     {"globe", shapes::globe({0.5, 0.25, -1}, 0.75)}};
  verdict v;
  for (const auto& [name, mesh] : convex) {
    const clearance::mesh_solid solid(mesh);
    const clearance::packing p = clearance::pack(solid, {.count = 200});
    double most_missed = 0;
    for (int k = 0; k < 300; ++k) {
      std::vector<vec3> points;
      double deepest = -std::numeric_limits<double>::infinity(), in_spheres = std::numeric_limits<double>::infinity();
      while (points.size() < 8) {
        const Vector3d u(d.uniform(0, 1), d.uniform(0, 1), d.uniform(0, 1)),
            at = solid.bounds().min() + u.cwiseProduct(solid.bounds().sizes());
        const vec3 q{clearance::to_float(at.x()), clearance::to_float(at.y()), clearance::to_float(at.z())};
        const Vector3d exact(q.x, q.y, q.z);
        if (depth(mesh, exact) <= 0) continue;
        points.push_back(q);
        deepest = std::max(deepest, depth(mesh, exact));
        double own = std::numeric_limits<double>::infinity();
        for (const auto& s : p.spheres)
          own = std::min(own, (exact - Vector3d(s.center.x, s.center.y, s.center.z)).norm() - s.radius);
        in_spheres = std::min(in_spheres, own);
        most_missed = std::max(most_missed, depth(mesh, exact) + own);
      }
      const double r = ask(p, points);
      v.require(std::abs(r - in_spheres) <= 1e-5, name, ": not the deepest in a sphere:", r, in_spheres);
      v.require(-r <= deepest + 1e-5, name, ": deeper than it is:", -r, deepest);
    }
    // It is no depth: between spheres it misses some, so nobody may take it for an upper bound.
    v.require(most_missed > 0.15 * p.gap, name, ": misses only", most_missed);
  }
}

TEST_CASE("At the centre of a sphere that touches the surface the penetration is the exact depth") {
  const auto cube = shapes::box({0, 0, 0}, {1, 1, 1});
  const clearance::packing p = clearance::pack(cube, {.count = 1});
  const auto& c = p.spheres[0].center;
  const double exact = depth(cube, {c.x, c.y, c.z});
  CHECK(-ask(p, {c}) == Approx(exact).margin(2e-6));
  CHECK(-ask(p, {c}) <= exact);
}

}  // namespace penetration_test
