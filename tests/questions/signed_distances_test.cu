// SPDX-License-Identifier: BSD-3-Clause
// On a device, every point's signed distance to closed meshes is that of all triangles, and of a crowd the host's.
#include "support/brute_signed.hpp"
#include "support/product_device.cuh"

#include <clearance/device.cuh>
#include <clearance/volume/aabb.hpp>

namespace signed_distances_test {

using namespace testing;
using clearance::device, clearance::host, clearance::placed, clearance::point_span, clearance::signed_distances;

TEST_CASE("Signed distances on a device are those of all triangles") {
  hold_signed_distances<clearance::aabb>(2, device{});
}

TEST_CASE("Signed distances of a crowd on a device are the host's") {
  verdict v;
  const device gpu;
  dice d(71);
  for (unsigned round = 0; round < 2; ++round) {
    const closed_parts parts = closed_scene(60 + round);
    const auto model = clearance::make_model<clearance::aabb>(parts.meshes);
    auto points = d.points(2000, 0.7), crowd = d.points(40000, 0.6);
    for (std::size_t k = 3; k < points.size(); k += 11) points[k].y = clearance::not_a_number;
    const std::vector two{placed{point_span(points), d.pose(0.1)}, placed{point_span(crowd), d.pose(0.1)}};
    for (const real d_max : {real(0), real(0.1), clearance::infinity})
      require_same(ask(gpu, model.on(gpu), parts.poses, two, signed_distances{d_max, true}),
                   ask(host{}, model, parts.poses, two, signed_distances{d_max, true}), v,
                   "round " + std::to_string(round) + ", d_max " + std::to_string(d_max));
  }
}

}  // namespace signed_distances_test
