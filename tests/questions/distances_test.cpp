// SPDX-License-Identifier: BSD-3-Clause
// Every point's distance is the least over all primitives of all parts, in every bit, with its part and primitive.
#include "solid/shapes.hpp"
#include "support/brute_distances.hpp"
#include "support/volumes.hpp"

#include <clearance/make_model.hpp>
#include <clearance/questions/distances.hpp>
#include <clearance/volume/aabb.hpp>
#include <clearance/volume/obb.hpp>
#include <clearance/volume/sphere.hpp>

namespace distances_test {

using namespace testing;
using clearance::distances, clearance::host, clearance::placed;

namespace {

template <class V, class P>
void all_scenes() {
  verdict v;
  for (const auto& s : scenes<P>()) {
    const auto model = make_model<V>(s, {}, clearance::wrapped{});
    for (const unsigned threads : {0u, 1u}) hold_distances(host{threads}, s, model, v);
  }
}

/// What a camera sees, row by row: slanted walls that end suddenly before others, and holes.
std::vector<vec3> raster(dice& d, const Eigen::Isometry3d& pose, double size) {
  std::vector<vec3> points;
  double depth = 1, slant = 0;
  for (int k = 0; k < 4000; ++k) {
    if (d.below(60) == 0) depth = d.number(0.3, 2), slant = d.number(-0.01, 0.01);
    depth += slant;
    const Eigen::Vector3d p = pose * (size * depth * Eigen::Vector3d(0.01 * (k % 80 - 40), 0.01 * (k / 80 - 25), 1));
    const real hole = d.below(12) == 0 ? clearance::not_a_number : 0;
    points.push_back({real(p.x()) + hole, real(p.y()), real(p.z())});
  }
  return points;
}

/// Parts among them and parts behind them; and robots whose parts lie far from their own origins, so that rounding is
/// coarser than the way between neighbours.
template <class V, class P>
void as_seen(double far) {
  dice d(97);
  verdict v;
  for (int round = 0; round < 4; ++round) {
    scene<P> s{"", {}, {}, {}, d.pose(0.2)};
    for (int k = 0; k < 6; ++k) {
      s.parts.push_back(random_primitives<P>(d, 1 + d.below(120), 0.2, 0.05));
      const vec3 off{real(far), 0, real(-far)};
      if constexpr (std::is_same_v<P, inner_sphere>)
        for (P& p : s.parts.back()) p.center = p.center + off;
      else
        for (P& p : s.parts.back()) p = triangle::from(p.a + off, p.b + off, p.c + off);
      s.poses.push_back(d.pose(round == 0 ? 0.3 : 1.5) * shifted(-off.x, 0, -off.z));
    }
    s.points = raster(d, s.cloud_pose.inverse(), round == 3 ? 0.05 : 1);
    const auto model = make_model<V>(s, {}, clearance::wrapped{});
    const clearance::point_span span(s.points);
    for (const real d_max : {real(-0.01), real(0.1), clearance::infinity}) {
      const auto expected = brute_distances(s, span, s.cloud_pose, d_max, nothing_inside);
      const std::string what =
          "round " + std::to_string(round) + ", " + std::to_string(far) + " m off, d_max " + std::to_string(d_max);
      require_same(ask(host{}, model, s.poses, placed{span, s.cloud_pose}, distances{d_max, true}), expected, v, what);
      require_same(ask(host{1}, model, s.poses, placed{span, s.cloud_pose}, distances{d_max, true}), expected, v,
                   what + ", one thread");
    }
  }
}

}  // namespace

TEST_CASE("Neighbours that walk together find what each finds alone") {
  for (const double far : {0.0, 3e4, 1e6}) {
    as_seen<clearance::sphere, inner_sphere>(far);
    as_seen<clearance::aabb, triangle>(far);
  }
  as_seen<clearance::obb, triangle>(0);
  as_seen<kdop14, inner_sphere>(0);  // says nothing without a root
}

TEST_CASE("Every point's distance to inner spheres is the least of all") {
  all_scenes<clearance::sphere, inner_sphere>();
  all_scenes<clearance::obb, inner_sphere>();
}
TEST_CASE("Every point's distance to triangles is the least of all") {
  all_scenes<clearance::aabb, triangle>();
  all_scenes<clearance::obb, triangle>();
}

TEST_CASE("A prepared question of distances on the host says the same") {
  verdict v;
  for (const auto& s : scenes<triangle>()) {
    const sources<triangle> all(s);
    const auto model = make_model<clearance::aabb>(s, {}, clearance::wrapped{});
    clearance::query query(host{}, model, distances{});
    const placed cloud{all.span, s.cloud_pose};
    for (const real d_max : {real(0.2), clearance::infinity}) {
      const auto expected = brute_distances(s, all.span, s.cloud_pose, d_max, nothing_inside);
      require_same(query(s.poses, cloud, {d_max, true}), expected, v, s.name);
      clearance::point_distances found = expected;
      std::ranges::fill(found.distance, -1.0f), found.part.clear(), found.primitive.clear(), found.counts = {};
      query.enqueue(s.poses, cloud, {d_max}, {{found.distance.data()}, &found.counts});
      require_same(found, expected, v, s.name + ", enqueued");
      query.forget();
    }
  }
  const auto model = make_model<clearance::aabb>(scenes<triangle>()[0], {}, clearance::wrapped{});
  clearance::query query(host{}, model, distances{});
  CHECK_THROWS_AS(query(scenes<triangle>()[0].poses, std::vector<vec3>{}, {clearance::not_a_number}),
                  std::invalid_argument);
}

TEST_CASE("A point inside a solid is 0 away, of the first part that it is in, and of none of its primitives") {
  const auto model = clearance::make_model<clearance::aabb>(std::vector(2, clearance::close_mesh(shapes::cube(1))));
  scene<triangle> s;
  dice d(93);
  for (const auto& part : model.parts()) {
    s.parts.emplace_back(part.tree.primitives.size());
    for (std::size_t k = 0; k < part.tree.primitives.size(); ++k)
      s.parts.back()[part.tree.ids[k]] = part.tree.primitives[k];
    s.poses.push_back(d.pose(0.5));
  }
  const auto points = d.points(3000, 2.5);
  const auto pose = d.pose(0.1);
  const clearance::point_span span(points);
  verdict v;
  for (const real d_max : {real(-1), real(0), real(0.5), clearance::infinity}) {
    const auto expected = brute_distances(
        s, span, pose, d_max, [&](std::uint32_t k, vec3 q) { return model.parts()[k].interior.view().inside(q); });
    const auto found = ask(host{}, model, s.poses, placed{span, pose}, distances{d_max, true});
    require_same(found, expected, v, "d_max " + std::to_string(d_max));
    CHECK((d_max < 0 || std::ranges::count(found.distance, 0.0f) > 100));
  }
}

TEST_CASE("What a distance leaves certain holds: no primitive is nearer than the lower bound, in exact arithmetic") {
  dice d(94);
  const auto s = scenes<inner_sphere>()[0];
  auto packed = clearance::make_part(clearance::build<clearance::sphere>(s.parts[0]), 0.01, 0.002);
  const clearance::model model{std::vector{packed}};
  const auto points = d.points(500, 3);
  const auto found = ask(host{}, model, std::span(s.poses.data(), 1), clearance::point_span(points), distances{});
  std::size_t positive = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d q = s.poses[0].inverse() * Eigen::Vector3d(points[i].x, points[i].y, points[i].z);
    double least = 1e9;
    for (const auto& b : s.parts[0])
      least = std::min(least, (q - Eigen::Vector3d(b.center.x, b.center.y, b.center.z)).norm() - b.radius);
    const double lower = found.certain.lower(found.distance[i]);
    positive += lower > 0;
    CHECK(lower <= std::max(0.0, least - 0.012));
    CHECK(lower >= least - 0.012 - 1e-4);
  }
  CHECK(positive > 100);
}

TEST_CASE("What cannot be asked is refused, and nothing is nowhere") {
  const auto s = scenes<inner_sphere>()[0];
  const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
  const clearance::point_span span(s.points);
  CHECK_THROWS_AS(ask(host{}, model, s.poses, span, distances{clearance::not_a_number}), std::invalid_argument);
  CHECK_THROWS_AS(ask(host{}, model, std::span(s.poses.data(), 1), span, distances{}), std::invalid_argument);
  const auto none = ask(host{}, model, s.poses, std::vector<clearance::point_span>{}, distances{});
  CHECK(none.distance.empty());
  CHECK(none.counts.seen == 0);
}

}  // namespace distances_test
