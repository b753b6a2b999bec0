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
    const auto two = two_clouds(s);
    const clearance::zones_options options{.thresholds = {0, 0.05 * s.size, 0.5 * s.size}};
    require_same(zones(gpu, model.on(gpu), s.poses, two, options), zones(host{}, model, s.poses, two, options), v, s.name);
  }
}

TEST_CASE("Crowds in zones are counted one by one") {
  verdict v;
  const device gpu;
  const auto s = crowd(97);
  const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
  const clearance::zones_options options{.thresholds = {0.02, 0.1, 0.3}};
  const auto found = zones(gpu, model.on(gpu), s.poses, point_span(s.points), options);
  require_same(found, zones(host{}, model, s.poses, point_span(s.points), options), v, "crowd");
  CHECK(found.of(0, 2).points > 10000);
}
