// SPDX-License-Identifier: BSD-3-Clause
// On a device points in zones are the host's.
#include "support/brute_zones.hpp"
#include "support/product_device.cuh"

#include <clearance/make_model.hpp>
#include <clearance/volume/sphere.hpp>
#include <clearance/zones.cuh>

using namespace testing;
using clearance::device, clearance::host, clearance::placed, clearance::point_span, clearance::zones;

TEST_CASE("Zones on a device hold what they hold on the host") {
  verdict v;
  const device gpu;
  for (const auto& s : scenes<inner_sphere>()) {
    const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
    const std::vector two{placed{point_span(s.points), s.cloud_pose}, placed{point_span(s.points.data(), s.points.size() / 2), shifted(0.1, 0, 0) * s.cloud_pose}};
    const clearance::zones_options options{.thresholds = {0, 0.05 * s.size, 0.5 * s.size}};
    require_same(zones(gpu, model.on(gpu), s.poses, two, options), zones(host{}, model, s.poses, two, options), v, s.name);
  }
}

TEST_CASE("Crowds in zones are counted one by one") {
  verdict v;
  const device gpu;
  dice d(97);
  scene<inner_sphere> s;
  for (int part = 0; part < 3; ++part) {
    s.parts.emplace_back();
    for (int k = 0; k < 100; ++k) s.parts.back().push_back({d.point(0.2f), d.number(0.005, 0.02)});
    s.poses.push_back(d.pose(0.3));
  }
  const auto points = d.points(300000, 0.6);
  const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
  const clearance::zones_options options{.thresholds = {0.02, 0.1, 0.3}};
  const auto found = zones(gpu, model.on(gpu), s.poses, point_span(points), options);
  require_same(found, zones(host{}, model, s.poses, point_span(points), options), v, "crowd");
  CHECK(found.of(0, 2).points > 10000);
}
