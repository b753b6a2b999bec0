// SPDX-License-Identifier: BSD-3-Clause
// On a device, points in zones are those of a plain loop, and in crowds the host's.
#include "solid/shapes.hpp"
#include "support/brute_zones.hpp"
#include "support/frames_device.cuh"

#include <clearance/device.cuh>
#include <clearance/make_model.hpp>
#include <clearance/volume/aabb.hpp>
#include <clearance/volume/sphere.hpp>

namespace zones_test {

using namespace testing;
using clearance::device, clearance::host, clearance::point_span;

namespace {

/// What a device says of very many points, in the bits of the host.
template <class Model>
clearance::zones_result of_crowd(const Model& model, const std::vector<Eigen::Isometry3d>& poses,
                                 const std::vector<vec3>& points, const std::vector<double>& thresholds) {
  verdict v;
  const device gpu;
  const clearance::zones q{.thresholds = thresholds};
  const auto found = ask(gpu, model.on(gpu), poses, point_span(points), q);
  require_same(found, ask(host{}, model, poses, point_span(points), q), v, "crowd");
  return found;
}

}  // namespace

TEST_CASE("Zones on a device hold what all points and spheres say") {
  zones_cases cases;
  hold_in_all_scenes<clearance::sphere, inner_sphere>(cases, device{});
  CHECK(cases.counted > 1000);
}

TEST_CASE("Crowds in zones are counted one by one") {
  const auto s = crowd(97);
  const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
  CHECK(of_crowd(model, s.poses, s.points, {0.02, 0.1, 0.3}).of(0, 2).points > 10000);
}

TEST_CASE("Crowds in and around solids are counted one by one") {
  dice d(102);
  const auto box = [&] { return clearance::make_part<clearance::aabb>(clearance::close_mesh(shapes::cube(1))); };
  const clearance::model boxes{std::vector{box(), box()}};
  const std::vector poses{d.pose(0.5), d.pose(0.5)};
  const auto found = of_crowd(boxes, poses, d.points(300000, 2), {0, 0.05, 0.5});
  CHECK((found.of(0, 0).points > 10000 && found.of(0, 1).points > found.of(0, 0).points));
}

TEST_CASE("A prepared question of zones says on a device in every frame what the host says, and in a graph") {
  zones_cases cases;
  hold_in_every_frame_on_a_device(cases, 121);
}

}  // namespace zones_test
