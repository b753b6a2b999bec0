// SPDX-License-Identifier: BSD-3-Clause
// The law of the bracket on all real data: every link of every robot and every mesh with an inside, packed; points
// around, near the surface, inside and in the gaps. The exact distance comes from the mesh's solid in double, which is
// checked by brute force in long double and solid angles; these share nothing with it.
#include "support/laws.hpp"
#include "support/oracle.hpp"
#include "support/places.hpp"
#include "support/random.hpp"

#include <clearance/io/mesh.hpp>
#include <clearance/io/robot.hpp>
#include <clearance/make_model.hpp>
#include <clearance/packing/pack.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/robot/model.hpp>
#include <clearance/solid/mesh_solid.hpp>
#include <clearance/volume/sphere.hpp>

#include <filesystem>
#include <numbers>

namespace law_test {

using namespace testing;
using Eigen::Vector3d;

namespace {

// Sanitizers take ten times as long: fewer solids, of fewer spheres, and fewer points.
#if defined(CLEARANCE_SANITIZED)
constexpr int points_a_solid = 900, one_of = 6, spheres_a_solid = 20;
#else
constexpr int points_a_solid = 27000, one_of = 1, spheres_a_solid = 100;
#endif

/// Winding number by the sum of solid angles (Van Oosterom & Strackee 1983), each as often as its triangle counts.
long double winding(const clearance::mesh_solid& s, oracle::vec q) {
  long double sum = 0;
  for (std::size_t i = 0; i < s.mesh().surface.triangles.size(); ++i) {
    const auto& t = s.mesh().surface.triangles[i];
    oracle::vec r[3];
    long double l[3];
    for (int k = 0; k < 3; ++k) {
      const Vector3d& c = s.corners()[t[k]];
      r[k] = oracle::vec{c.x(), c.y(), c.z()} - q, l[k] = oracle::length(r[k]);
    }
    const oracle::vec cross{r[1].y * r[2].z - r[1].z * r[2].y, r[1].z * r[2].x - r[1].x * r[2].z,
                            r[1].x * r[2].y - r[1].y * r[2].x};
    sum += 2 * s.mesh().counts[i] *
           std::atan2(oracle::dot(r[0], cross), l[0] * l[1] * l[2] + oracle::dot(r[0], r[1]) * l[2] +
                                                    oracle::dot(r[1], r[2]) * l[0] + oracle::dot(r[2], r[0]) * l[1]);
  }
  return sum / (4 * std::numbers::pi_v<long double>);
}

/// Is it in a cube that the flood from outside did not reach?
bool in_a_cube(const clearance::enclosure_grid& grid, const Vector3d& q) {
  if (grid.bits.empty()) return false;
  const Vector3d at = (q - grid.low) / grid.cube;
  for (int k = 0; k < 3; ++k)
    if (at[k] < 0 || at[k] >= grid.size[k]) return false;
  const auto row = std::size_t(at.z()) * grid.size[1] + std::size_t(at.y());
  const std::size_t cube = row * grid.size[0] + std::size_t(at.x());
  return (grid.bits[cube / 32] >> cube % 32 & 1) != 0;
}

long double to_surface(const clearance::mesh_solid& s, oracle::vec q) {
  long double best = std::numeric_limits<long double>::infinity();
  for (const auto& t : s.mesh().surface.triangles) {
    oracle::vec c[3];
    for (int k = 0; k < 3; ++k) c[k] = {s.corners()[t[k]].x(), s.corners()[t[k]].y(), s.corners()[t[k]].z()};
    best = std::min(best, oracle::to_triangle(q, c[0], c[1], c[2]));
  }
  return best;
}

struct census {
  std::size_t seen = 0, solids = 0, without_inside = 0, points = 0, inside = 0, in_gaps = 0, by_brute_force = 0;
};

void check(const clearance::triangle_mesh& mesh, const std::string& name, census& all, verdict& v) {
  if (all.seen++ % one_of != 0) return;
  const auto solid = [&]() -> std::optional<clearance::mesh_solid> {
    try {
      return clearance::mesh_solid(mesh);
    } catch (const std::invalid_argument&) {
      return {};  // a sheet or the like, which says so; other tests look at what it says
    }
  }();
  if (!solid) {
    ++all.without_inside;
    return;
  }
  ++all.solids;
  const clearance::packing spheres = clearance::pack(*solid, {.count = spheres_a_solid});
  const clearance::model model{std::vector{clearance::make_part<clearance::sphere>(spheres)}};
  clearance::query ask(clearance::host{.threads = 1}, model, clearance::min_distance{});
  const std::vector<Eigen::Isometry3d> pose = {Eigen::Isometry3d::Identity()};
  const auto law = [&](const Vector3d& at, bool brute) {
    const vec3 p{clearance::to_float(at.x()), clearance::to_float(at.y()), clearance::to_float(at.z())};
    const Vector3d q(p.x, p.y, p.z);
    const bool inside = solid->inside(q);
    const double surface = solid->distance(q), exact = inside ? 0 : surface;
    const auto r = ask(pose, clearance::point_span(&p, 1));
    v.require(r.lower <= exact, name, p, ": lower", r.lower, "but", exact, inside ? "(inside)" : "");
    if (solid->mesh().inside == clearance::inside_by::flood && exact > r.upper) {
      // A passage is a wall, so the solid may begin where no surface is: in front of the sphere's middle.
      const vec3 c = spheres.spheres[r.primitive].center;
      const Vector3d way = Vector3d(c.x, c.y, c.z) - q;
      v.require(solid->inside(q + std::min(1.0, r.upper / way.norm()) * way), name, p, ": upper", r.upper, "but",
                exact);
      return;
    }
    v.require(exact <= r.upper, name, p, ": upper", r.upper, "but", exact);
    // The surface of an inner shell is no nearer than the solid's own, so this is the stricter law.
    const double error = 1e-6 * (q.norm() + model.parts()[0].facts.radius) + spheres.tolerance;
    v.require((inside ? -surface : surface) <= r.distance + error, name, p, ": signed distance",
              inside ? -surface : surface, "above", r.distance);
    ++all.points, all.inside += inside, all.in_gaps += inside && r.distance > 0;
    if (!brute) return;
    const oracle::vec w{q.x(), q.y(), q.z()};
    const long double truth = to_surface(*solid, w);
    v.require(std::abs(truth - surface) <= 1e-9 * (1 + std::abs(truth)), name, p, ": distances differ:", double(truth),
              surface);
    if (truth > 1e-6 * solid->bounds().diagonal().norm())
      v.require((winding(*solid, w) > 0.5L || in_a_cube(solid->mesh().enclosed, q)) == inside, name, p,
                ": inside differs");
    ++all.by_brute_force;
  };
  dice d(unsigned(all.solids));
  const auto box = solid->bounds();
  const auto anywhere = [&](double room) {
    const Vector3d u(d.number(-room, 1 + room), d.number(-room, 1 + room), d.number(-room, 1 + room));
    return Vector3d(box.min() + u.cwiseProduct(box.sizes()));
  };
  const int third = points_a_solid / 3, seldom = points_a_solid / 3;
  for (int i = 0; i < third; ++i) law(anywhere(0.5), i % seldom == 1);
  const auto surface = solid->surface_points(std::size_t(third));
  for (int i = 0; i < third; ++i) {
    const vec3 way = d.direction();
    law(surface[std::size_t(i)] + d.number(0, 1.5 * spheres.gap) * Vector3d(way.x, way.y, way.z), i % seldom == 1);
  }
  for (int i = 0, tries = 0; i < third && tries < 40 * third; ++tries)
    if (const Vector3d at = anywhere(0); solid->inside(at)) law(at, i % seldom == 1), ++i;
}

}  // namespace

TEST_CASE("The bracket holds and the signed distance is never above the spheres': every robot's links", "[data]") {
  namespace io = clearance::io;
  const std::filesystem::path robots = std::filesystem::path(testing::data("/robots"));
  census all;
  verdict v;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(robots)) {
    if (entry.path().extension() != ".urdf") continue;
    const auto robot = io::load_robot(entry.path(), {.geometry = io::robot_geometry::collision});
    for (const auto& part : robot.parts()) check(part.mesh, entry.path().stem().string() + " " + part.name, all, v);
  }
  WARN(all.solids << " links, " << all.points << " points, " << all.inside << " inside, " << all.in_gaps
                  << " of them in gaps, " << all.by_brute_force << " checked by brute force; " << all.without_inside
                  << " without an inside");
  CHECK(all.solids > 50 / one_of);
  CHECK(all.in_gaps > all.points / 50);
}

TEST_CASE("The bracket holds and the signed distance is never above the spheres': every mesh with an inside",
          "[data]") {
  const std::filesystem::path meshes = std::filesystem::path(testing::data("/meshes"));
  census all;
  std::size_t unread = 0;
  verdict v;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(meshes)) {
    const std::string kind = entry.path().extension().string();
    if (kind != ".obj" && kind != ".off" && kind != ".ply" && kind != ".stl" && kind != ".STL") continue;
    try {
      check(clearance::io::load_mesh(entry.path()), entry.path().filename().string(), all, v);
    } catch (const std::runtime_error&) {
      ++unread;  // refused with a sentence; tests/io looks at those
    }
  }
  WARN(all.solids << " meshes, " << all.points << " points, " << all.inside << " inside, " << all.in_gaps
                  << " of them in gaps, " << all.by_brute_force << " checked by brute force; " << all.without_inside
                  << " without an inside, " << unread << " unreadable");
  CHECK(all.solids > 40 / one_of);
  CHECK(all.in_gaps > all.points / 50);
}

}  // namespace law_test
