// SPDX-License-Identifier: BSD-3-Clause
// The law of the inside: whatever is wrong with a mesh, a point deeper inside than the damage is never free, and one
// farther outside is never in collision. CLEARANCE_INSIDE_RUNS sets the number of damaged solids to try
// (tests/solid/inside-law).
#include "solid/damaged.hpp"
#include "support/catch.hpp"
#include "support/laws.hpp"
#include "support/places.hpp"

#include <clearance/make_model.hpp>
#include <clearance/packing/pack.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/volume/aabb.hpp>
#include <clearance/volume/sphere.hpp>

#include <cstdlib>
#include <filesystem>

namespace inside_test {

using namespace testing;

namespace {

#if defined(CLEARANCE_SANITIZED)
constexpr unsigned usual_runs = 132;  // each kind of damage by itself, and each pair, once; they take ten times as long
#else
constexpr unsigned usual_runs = 2000;
#endif

unsigned number_of(const char* variable, unsigned usual) {
  const char* given = std::getenv(variable);
  return given ? unsigned(std::strtoul(given, nullptr, 10)) : usual;
}

struct census {
  std::size_t inside = 0, collision = 0, outside = 0, free = 0;
};

/// Asks about each point by itself.
template <class Part>
void law(const Part& part, const damaged_solid& s, const std::string& what, const std::vector<Vector3d>& points,
         census& all, verdict& v) {
  const clearance::model model{std::vector{part}};
  clearance::query ask(clearance::host{.threads = 1}, model, clearance::min_distance{});
  const double rounding = 1e-5 * s.size(), unsure = part.facts.tolerance + double(part.facts.gap);
  for (const Vector3d& at : points) {
    const vec3 p{real(at.x()), real(at.y()), real(at.z())};
    const auto r = ask(std::vector<Eigen::Isometry3d>{Eigen::Isometry3d::Identity()}, clearance::point_span(&p, 1));
    const double truth = s.truth.signed_distance(at);
    const auto says = [&] {
      return std::string(clearance::to_string(r.state)) + " at " + std::to_string(truth) + ", damage " +
             std::to_string(s.damage);
    };
    if (-truth > s.damage + rounding) v.require(r.state != clearance::state::free, what, p, says());
    if (truth > s.damage + rounding) v.require(r.state != clearance::state::collision, what, p, says());
    v.require(r.lower <= std::max(truth, 0.0) + s.damage + rounding, what, p, ": lower", r.lower, says());
    // The other side: nothing that the damage does not excuse hangs between the point and the solid.
    v.require(r.upper >= truth - s.damage - rounding, what, p, ": upper", r.upper, says());
    // An answer that is always "possible" would keep the law, and be of no use.
    if (-truth > s.damage + unsure + rounding && s.truth.to_surface(at) > s.damage + unsure + rounding)
      ++all.inside, all.collision += r.state == clearance::state::collision;
    if (truth > s.damage + unsure + rounding) ++all.outside, all.free += r.state == clearance::state::free;
  }
}

void runs(unsigned first, unsigned count, const std::vector<clearance::triangle_mesh>& more, unsigned one_packed_of) {
  verdict v;
  census triangles, spheres;
  for (unsigned k = first; k < first + count; ++k) {
    const damaged_solid s = damaged(k, more);
    const std::vector<Vector3d> points = probes(s, k, 9);
    const std::string what = "run " + std::to_string(k) + " (" + s.history + ")";
    const clearance::closed_mesh closed = clearance::close_mesh(s.mesh);
    law(clearance::make_part<clearance::aabb>(closed), s, what + ", triangles", points, triangles, v);
    if (k % one_packed_of != 0 || closed.inside == clearance::inside_by::nothing) continue;
    const clearance::packing packed = clearance::pack(clearance::mesh_solid(closed), {.count = 40});
    law(clearance::make_part<clearance::sphere>(packed), s, what + ", spheres", points, spheres, v);
  }
  v.require(double(triangles.collision) >= 0.99 * double(triangles.inside), "inside:", triangles.inside,
            "but in collision:", triangles.collision);
  v.require(double(triangles.free) >= 0.99 * double(triangles.outside), "outside:", triangles.outside,
            "but free:", triangles.free);
  v.require(double(spheres.free) >= 0.99 * double(spheres.outside), "outside of spheres:", spheres.outside,
            "but free:", spheres.free);
  v.require(triangles.inside > count && triangles.outside > count, "too few points decide");
}

}  // namespace

TEST_CASE("What is deeper inside than the damage is never free, and what is farther outside never in collision") {
  runs(number_of("CLEARANCE_INSIDE_FIRST", 0), number_of("CLEARANCE_INSIDE_RUNS", usual_runs), {}, 10);
}

TEST_CASE("The closed links of real robots keep the law of the inside, whatever damage they take", "[data]") {
  std::vector<clearance::triangle_mesh> links;
  for (const char* name : {"base", "forearm", "shoulder", "upperarm", "wrist1", "wrist2", "wrist3"}) {
    const auto file =
        std::filesystem::path(testing::data("/robots/ur5e/meshes/collision")) / (std::string(name) + ".stl");
    if (const auto mesh = shapes::binary_stl(file.string());
        !mesh.triangles.empty() && clearance::close_mesh(mesh).inside == clearance::inside_by::closed)
      links.push_back(mesh);
  }
  if (links.empty()) {
    WARN("SKIPPED: no robots in " << testing::data());
    return;
  }
  runs(number_of("CLEARANCE_INSIDE_FIRST", 0), number_of("CLEARANCE_INSIDE_RUNS", usual_runs) / 10, links, 20);
}

TEST_CASE("How the inside of a part is known is said") {
  using clearance::close_mesh, clearance::inside_by;
  const auto cube = shapes::box({0, 0, 0}, {1, 1, 1});
  CHECK(close_mesh(cube).inside == inside_by::closed);
  CHECK(close_mesh(cube).tolerance == 0);
  auto open = cube;
  open.triangles.pop_back();
  CHECK(close_mesh(open).inside == inside_by::caps);
  CHECK(close_mesh(open, {.cap = false}).inside == inside_by::nothing);
  clearance::triangle_mesh sheet{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
  CHECK(close_mesh(sheet).inside == inside_by::nothing);
  CHECK(close_mesh(sheet).tolerance == 0);
  // Six sides, none of which touches another: no edge is shared, and what they enclose is enclosed all the same.
  auto loose = shapes::soup(cube);
  for (std::size_t i = 0; i < loose.vertices.size(); ++i) loose.vertices[i] += 1e-3 * Vector3d::Unit(int(i / 6) / 2);
  const auto flooded = close_mesh(loose);
  CHECK(flooded.inside == inside_by::flood);
  CHECK(flooded.tolerance < 0.03);
  CHECK(clearance::make_winding(flooded).view().inside(vec3{.5f, .5f, .5f}));
  CHECK_FALSE(clearance::make_winding(flooded).view().inside(vec3{1.5f, .5f, .5f}));
}

TEST_CASE("Shapes of one link that make a room between them leave it free") {
  // Four walls, a floor and a lid, each a box of its own.
  clearance::triangle_mesh room;
  for (int axis = 0; axis < 3; ++axis)
    for (const double at : {0.0, 0.9}) {
      Vector3d low(0, 0, 0), high(1, 1, 1);
      low[axis] = at, high[axis] = at + 0.1;
      room.shapes.push_back(std::uint32_t(room.triangles.size()));
      const auto cuts = room.shapes;
      room = shapes::merged(room, shapes::box(low, high));
      room.shapes = cuts;
    }
  const auto closed = clearance::close_mesh(room);
  CHECK(closed.inside == clearance::inside_by::closed);
  const auto w = clearance::make_winding(closed);
  CHECK_FALSE(w.view().inside(vec3{.5f, .5f, .5f}));
  CHECK(w.view().inside(vec3{.05f, .5f, .5f}));
}

}  // namespace inside_test
