// SPDX-License-Identifier: BSD-3-Clause
// On a device the point within a margin is the host's.
#include "support/brute_pairs.hpp"
#include "support/product_device.cuh"

#include <clearance/in_collision.cuh>
#include <clearance/make_model.hpp>
#include <clearance/volume/sphere.hpp>

using namespace testing;
using clearance::device, clearance::host, clearance::in_collision, clearance::placed, clearance::point_span, clearance::state;

namespace {

bool same(const clearance::collision_result& a, const clearance::collision_result& b) {
  return a.state == b.state && a.cloud == b.cloud && a.point == b.point && a.part == b.part && a.counts.valid == b.counts.valid;
}

}  // namespace

TEST_CASE("On a device a point within a margin is the host's, in all scenes") {
  verdict v;
  const device gpu;
  for (const auto& s : scenes<inner_sphere>()) {
    const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
    const auto there = model.on(gpu);
    const auto two = two_clouds(s);
    for (const double margin : {-0.1, 0.0, 1e-7, 0.02, 0.3})
      v.require(same(in_collision(gpu, there, s.poses, two, margin * s.size), in_collision(host{}, model, s.poses, two, margin * s.size)), s.name, ", margin ",
                margin, ": differs from the host's");
  }
}

TEST_CASE("In a crowd the first point is found again and again") {
  const device gpu;
  const auto s = crowd(98);
  const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
  const auto there = model.on(gpu);
  for (const double margin : {0.0, 0.001, 0.3}) {
    const auto expected = in_collision(host{}, model, s.poses, point_span(s.points), margin);
    CHECK(expected.state == state::collision);
    for (int k = 0; k < 5; ++k) CHECK(same(in_collision(gpu, there, s.poses, point_span(s.points), margin), expected));
  }
}
