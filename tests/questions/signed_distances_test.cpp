// SPDX-License-Identifier: BSD-3-Clause
// Every point's signed distance to closed meshes is that of all triangles and a ray's crossings, in every bit; and it
// is the true depth.
#include "support/brute_signed.hpp"

#include <clearance/volume/aabb.hpp>

namespace signed_distances_test {

using namespace testing;
using clearance::host, clearance::signed_distances;

TEST_CASE("Signed distances to closed meshes are those of all triangles, negative inside") {
  hold_signed_distances<clearance::aabb>(3, host{}, host{1});
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
