// SPDX-License-Identifier: BSD-3-Clause
// Every point's signed distance to closed meshes is that of all triangles and a ray's crossings, in every bit; and it
// is the true depth.
#include "support/brute_signed.hpp"

#include <clearance/make_model.hpp>
#include <clearance/questions/signed_distances.hpp>
#include <clearance/volume/aabb.hpp>

namespace signed_distances_test {

using namespace testing;
using clearance::host, clearance::placed, clearance::point_span, clearance::signed_distances;

TEST_CASE("Signed distances to closed meshes are those of all triangles, negative inside") {
  verdict v;
  for (unsigned round = 0; round < 3; ++round) {
    const closed_parts parts = closed_scene(60 + round);
    const auto model = clearance::make_model<clearance::aabb>(parts.meshes);
    scene<triangle> s = triangles_of(parts);
    dice d(61 + round);
    s.points = d.points(1500, 0.7);
    for (std::size_t k = 3; k < s.points.size(); k += 11) s.points[k].y = clearance::not_a_number;
    for (int k = 0; k < 60; ++k) {  // on surfaces, as floats can say it
      const auto& own = s.parts[k % s.parts.size()];
      const triangle& t = own[d.below(unsigned(own.size()))];
      const Eigen::Vector3d at = s.poses[k % s.parts.size()] * Eigen::Vector3d(t.a.x, t.a.y, t.a.z);
      s.points.push_back({real(at.x()), real(at.y()), real(at.z())});
    }
    const sources<triangle> all(s);
    const placed cloud{all.span, d.pose(0.1)};
    for (const real d_max : {real(0), real(0.1), clearance::infinity}) {
      auto expected = brute_signed(parts, cloud.source, cloud.pose, d_max);
      const std::string what = "round " + std::to_string(round) + ", d_max " + std::to_string(d_max);
      require_same(ask(host{1}, model, s.poses, cloud, signed_distances{d_max, true}), expected, v, what);
      const auto deep = std::ranges::count_if(expected.distance, [](real x) { return x < real(-0.02); });
      v.require(deep > 50, what, ": only ", deep, " points are inside");
      append(expected, brute_signed(parts, all.raw, all.camera_pose, d_max));
      require_same(
          ask(host{}, model, s.poses, std::tuple(cloud, placed{all.raw, all.camera_pose}), signed_distances{d_max}),
          expected, v, what + ", two clouds");
    }
  }
}

TEST_CASE("The signed distance to a box is the one known by hand, on its surface too") {
  const auto model = clearance::make_model<clearance::aabb>(
      std::vector(2, clearance::close_mesh(shapes::box({-1, -2, -3}, {1, 2, 3}))));
  std::vector poses(2, Eigen::Isometry3d::Identity());
  poses[1].translation().x() = 0.5;
  const std::vector<vec3> points{{0, 0, 0},
                                 {-0.75f, 0, 0},
                                 {1.25f, 1, 1},
                                 {2.5f, 0, 0},
                                 {-1, 0, 0},
                                 {4.5f, 6, 0},
                                 {clearance::not_a_number, 0, 0}};
  const auto found = ask(host{}, model, poses, points, signed_distances{.which = true});
  const std::vector<real> expected{-1, -0.25f, -0.25f, 1, 0, 5};
  for (std::size_t i = 0; i < expected.size(); ++i) CHECK(found.distance[i] == expected[i]);
  CHECK(found.distance[6] != found.distance[6]);
  CHECK((found.part == std::vector<std::uint32_t>{0, 0, 1, 1, 0, 1, ~0u} && found.primitive[6] == ~0u &&
         found.primitive[0] != ~0u));
  CHECK(!std::signbit(found.distance[4]));
  CHECK((found.counts.seen == 7 && found.counts.valid == 6));
  CHECK(ask(host{}, model, poses, points, signed_distances{.d_max = 0.5f}).distance[3] == infinity);
  CHECK_THROWS_AS(ask(host{}, model, poses, points, signed_distances{.d_max = -0.5f}), std::invalid_argument);
  CHECK_THROWS_AS(ask(host{}, model, poses, points, signed_distances{.d_max = clearance::not_a_number}),
                  std::invalid_argument);
}

}  // namespace signed_distances_test
