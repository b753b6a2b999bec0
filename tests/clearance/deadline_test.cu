// SPDX-License-Identifier: BSD-3-Clause
// On a device, a least distance with a deadline is the host's, cut after the same pieces.
#include "support/closed.hpp"
#include "support/product_device.cuh"

#include <clearance/deadline.hpp>
#include <clearance/device.cuh>
#include <clearance/make_model.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/volume/aabb.hpp>
#include <clearance/volume/sphere.hpp>

namespace deadline_test {

using namespace testing;
using namespace std::chrono_literals;
using clearance::device, clearance::host, clearance::infinity, clearance::min_distance, clearance::placed;

namespace {

/// After every other number of pieces, and of all.
template <class Model, class Clouds>
void same_cuts(const Model& on_host, const std::vector<Eigen::Isometry3d>& poses, const Clouds& clouds,
               std::size_t piece, verdict& v, const std::string& what) {
  const device gpu;
  const auto model = on_host.on(gpu);
  clearance::query query(gpu, model, min_distance{});
  clearance::query expected(host{1}, on_host, min_distance{});
  for (std::size_t pieces = 0, unseen = 1; unseen != 0; pieces = 2 * pieces + 1) {
    const auto go_on = [pieces] { return [left = pieces]() mutable { return left-- > 0; }; };
    const auto r = ask_while(query, poses, clouds, go_on(), min_distance{}, {.piece = piece});
    const auto e = ask_while(expected, poses, clouds, go_on(), min_distance{}, {.piece = piece});
    v.require(same_result(r.result, e.result) && r.unseen == e.unseen, what, " after", pieces, " pieces");
    unseen = r.unseen;
  }
  v.require(same_result(query(poses, clouds), ask(host{1}, on_host, poses, clouds, min_distance{})), what,
            ": a frame without a deadline, afterwards");
  v.require(same_result(ask_by(gpu, model, poses, clouds, 1h, min_distance{}).result,
                        ask(host{1}, on_host, poses, clouds, min_distance{})),
            what, ", one call");
}

}  // namespace

TEST_CASE("A device that is stopped after some pieces says what the host says") {
  verdict v;
  for (const auto& s : scenes<inner_sphere>()) {
    const sources<inner_sphere> all(s);
    const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
    same_cuts(model, s.poses, std::tuple(placed{all.raw, all.camera_pose}, placed{all.span, s.cloud_pose}), 100, v,
              s.name);
  }
}

TEST_CASE("Points inside closed meshes, and more parts than a kernel takes, in pieces") {
  verdict v;
  dice d(84);
  const auto [meshes, poses] = closed_scene(82);
  for (const double half : {0.5, 4.0})
    same_cuts(clearance::make_model<clearance::aabb>(meshes), poses, d.points(30000, half), 1000, v, "meshes");
  scene<inner_sphere> many{"many parts", {}, {}, d.points(20000, 3)};
  for (int k = 0; k < 300; ++k) many.parts.push_back({{{0, 0, 0}, 0.05f}}), many.poses.push_back(d.pose(2));
  same_cuts(make_model<clearance::sphere>(many, {}, clearance::wrapped{}), many.poses, many.points, 1000, v, many.name);
}

TEST_CASE("A device has no time, or deadlines that are none") {
  const device gpu;
  const auto on_host =
      clearance::make_model<clearance::sphere>(std::vector<std::vector<inner_sphere>>{{{{0, 0, 0}, 1}}});
  const auto model = on_host.on(gpu);
  const std::vector poses{Eigen::Isometry3d::Identity()};
  const std::vector<vec3> points(100000, vec3{3, 0, 0});
  const auto none = ask_by(gpu, model, poses, points, 0s, min_distance{});
  const auto& r = none.result;
  CHECK((none.unseen == 100000 && r.seen == 0 && r.state == clearance::state::no_data && r.lower == 0 &&
         r.upper == infinity));
  CHECK_THROWS_AS(ask_by(gpu, model, poses, points, -1s, min_distance{}), std::invalid_argument);
  CHECK_THROWS_AS(ask_by(gpu, model, std::vector(2, poses[0]), points, 0s, min_distance{}), std::invalid_argument);
}

}  // namespace deadline_test
