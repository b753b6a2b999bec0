// SPDX-License-Identifier: BSD-3-Clause
// On a device points in zones are the host's.
#include "support/brute_zones.hpp"
#include "support/product_device.cuh"

#include <clearance/make_model.hpp>
#include <clearance/volume/aabb.hpp>
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

TEST_CASE("Crowds in and around solids are counted one by one") {
  verdict v;
  const device gpu;
  dice d(102);
  clearance::triangle_mesh m;
  for (int k = 0; k < 8; ++k) m.vertices.emplace_back(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1);
  m.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4}, {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  const auto box = [&] { return clearance::make_part<clearance::aabb>(clearance::close_mesh(m)); };
  const clearance::model boxes{std::vector{box(), box()}};
  const std::vector poses{d.pose(0.5), d.pose(0.5)};
  const auto crowd = d.points(300000, 2);
  const clearance::zones_options options{.thresholds = {0, 0.05, 0.5}};
  const auto found = zones(gpu, boxes.on(gpu), poses, point_span(crowd), options);
  require_same(found, zones(host{}, boxes, poses, point_span(crowd), options), v, "boxes");
  CHECK((found.of(0, 0).points > 10000 && found.of(0, 1).points > found.of(0, 0).points));
}
