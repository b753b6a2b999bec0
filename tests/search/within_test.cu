// SPDX-License-Identifier: BSD-3-Clause
// On a device points within a distance are the host's.
#include "support/brute_within.hpp"
#include "support/product_device.cuh"

#include <clearance/make_model.hpp>
#include <clearance/volume/sphere.hpp>
#include <clearance/within.cuh>

using namespace testing;
using clearance::device, clearance::host, clearance::placed, clearance::point_span, clearance::within;

TEST_CASE("On a device points within a distance are the host's, and a long list is whole") {
  verdict v;
  const device gpu;
  for (const auto& s : scenes<inner_sphere>()) {
    const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
    const auto two = two_clouds(s);
    for (const real radius : {real(0), real(0.1), clearance::infinity})
      require_same(within(gpu, model.on(gpu), s.poses, two, radius), within(host{}, model, s.poses, two, radius), v, s.name + ", within " + std::to_string(radius));
  }
  dice d(99);
  scene<inner_sphere> s;
  for (int part = 0; part < 2; ++part) s.parts.push_back({{{0.1f * float(part), 0, 0}, 0.1f}}), s.poses.push_back(Eigen::Isometry3d::Identity());
  s.points = d.points(50000, 1);
  const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
  const std::vector cloud{placed{point_span(s.points)}};
  require_same(within(gpu, model.on(gpu), s.poses, cloud, 10), within(host{}, model, s.poses, cloud, 10), v, "many");
}
