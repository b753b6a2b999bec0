// SPDX-License-Identifier: BSD-3-Clause
// On a device, too, each part's own gap and tolerance is taken from its own distance.
#include "questions/tolerances.hpp"
#include "support/product_device.cuh"

#include <clearance/device.cuh>

namespace tolerances_test {

using namespace testing;

TEST_CASE("On a device a robot is at least as far as its parts, each less its own gap and tolerance") {
  rule_of_slop rule;
  dice d(81);
  for (int n = 0; n < 40; ++n) {
    const bool any = n % 6 != 5;
    const std::string what = "robot " + std::to_string(n);
    rule.least(clearance::device{}, sloppy_spheres<clearance::sphere>(d, any), d, any, what);
    rule.least(clearance::device{}, sloppy_solids(d, any), d, any, what + ", solids");
  }
  CHECK(rule.other >= 10);
}

TEST_CASE("More parts than a kernel takes, and several devices, take each part's own, too") {
  verdict v;
  dice d(82);
  const clearance::device gpu;
  const clearance::devices both{0, 0};
  constexpr int most = clearance::scan::most_parts + 20;
  for (int n = 0; n < 6; ++n) {
    std::vector<clearance::part<clearance::bvh<clearance::sphere, inner_sphere>>> parts;
    for (int k = 0; k < most; ++k)
      parts.push_back(
          with_slop(d, clearance::make_part(clearance::build<clearance::sphere>(random_spheres(d, 6, 0.1))), true));
    const clearance::model model(std::move(parts));
    const auto poses = some_poses(d, most);
    const auto points = d.points(20000, 3);
    const auto expected = ask(clearance::host{}, model, poses, points, clearance::min_distance_per_part{}).all;
    v.require(same_result(ask(clearance::host{}, model, poses, points, clearance::min_distance{}), expected), "host",
              n);
    v.require(same_result(ask(gpu, model.on(gpu), poses, points, clearance::min_distance{}), expected), "device", n);
    v.require(same_result(ask(both, model.on(both), poses, points, clearance::min_distance{}), expected), "devices", n);
    v.require(same_result(ask(gpu, model.on(gpu), poses, points, clearance::min_distances{}).of[0], expected),
              "many configurations", n);
  }
}

namespace {

/// The parts lie apart, and another one is the nearest in each frame: most of them are not looked for to the end.
template <class Model>
void moves(const Model& model, dice& d, verdict& v, int n) {
  const clearance::device gpu;
  const auto there = model.on(gpu);
  clearance::query query(gpu, there, clearance::min_distance{});
  const std::size_t parts = model.view().size();
  for (int frame = 0; frame < 30; ++frame) {
    auto poses = some_poses(d, parts);
    for (std::size_t k = 0; k < parts; ++k) poses[k].translation().x() += 2.0 * double(k);
    const std::size_t near = d.below(unsigned(parts));
    auto points = d.points(frame % 7 == 6 ? 0 : 5000, 1);
    for (vec3& p : points)
      p = clearance::scaled(d.number(1, 1.4) / std::max(0.1f, clearance::length(p)), p), p.x += 2.0f * float(near);
    const clearance::point_span cloud(points), half(std::span<const vec3>(points).first(points.size() / 2));
    const auto expected = ask(clearance::host{}, model, poses, cloud, clearance::min_distance{});
    v.require(same_result(query(poses, cloud), expected), "robot", n, "frame", frame);
    const std::tuple two(half, clearance::placed{cloud, d.pose(0.1)});
    v.require(same_result(query(poses, two), ask(clearance::host{}, model, poses, two, clearance::min_distance{})),
              "robot", n, "frame", frame, "of two clouds");
    if (frame % 10 == 9) query.forget();
  }
}

}  // namespace

TEST_CASE("A robot that moves is as far as its parts, each less its own, whichever of them the last frame looked for") {
  verdict v;
  dice d(83);
  for (int n = 0; n < 6; ++n) {
    moves(sloppy_spheres<clearance::sphere>(d, true), d, v, n);
    moves(sloppy_solids(d, true), d, v, n);
  }
}

TEST_CASE("On a device, too, nothing is known of a robot without parts") {
  const clearance::device gpu;
  dice d(84);
  const auto robot = sloppy_spheres<clearance::sphere>(d, true);
  const clearance::model_view<std::remove_cvref_t<decltype(robot)>::view_type> no_parts{nullptr, {}, 0, 0};
  const std::span<const Eigen::Isometry3d> no_poses;
  const auto points = d.points(3000, 1);
  const clearance::point_span cloud(points);
  const auto nearest = ask(gpu, no_parts, no_poses, cloud, clearance::min_distance{});
  const auto each = ask(gpu, no_parts, no_poses, cloud, clearance::min_distance_per_part{});
  CHECK((nearest.state == clearance::state::no_data && nearest.valid == points.size()));
  CHECK((each.all.state == clearance::state::no_data && each.parts.empty()));
}

}  // namespace tolerances_test
