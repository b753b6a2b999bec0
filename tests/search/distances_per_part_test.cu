// SPDX-License-Identifier: BSD-3-Clause
// On a device every part's distances are the host's.
#include "support/brute_per_part.hpp"
#include "support/product_device.cuh"

#include <clearance/distances_per_part.cuh>
#include <clearance/make_model.hpp>
#include <clearance/volume/sphere.hpp>

using namespace testing;
using clearance::device, clearance::host, clearance::distances_per_part;

TEST_CASE("On a device every part's distances are the host's, to the bit") {
  verdict v;
  const device gpu;
  for (auto s : scenes<inner_sphere>()) {
    if (s.points.size() > 3) s.points[1].x = clearance::not_a_number;
    const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
    const auto two = two_clouds(s);
    for (const real d_max : {real(0.2 * s.size), clearance::infinity}) {
      const std::string what = s.name + ", d_max " + std::to_string(d_max);
      require_same(distances_per_part(gpu, model.on(gpu), s.poses, two, d_max), distances_per_part(host{}, model, s.poses, two, d_max), v, what);
    }
  }
}
