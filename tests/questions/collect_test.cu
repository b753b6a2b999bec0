// SPDX-License-Identifier: BSD-3-Clause
// The device gives an answer the same pairs as the host.
#include "solid/shapes.hpp"
#include "support/product_device.cuh"
#include "support/tallied.hpp"

#include <clearance/device.cuh>
#include <clearance/make_model.hpp>
#include <clearance/questions/collect.hpp>
#include <clearance/volume/aabb.hpp>
#include <clearance/volume/obb.hpp>
#include <clearance/volume/sphere.hpp>

namespace collect_test {

using namespace testing;
using clearance::device, clearance::host, clearance::placed, clearance::point_span;

namespace {

template <class Model, class Clouds>
void same_pairs(const Model& on_host, const std::vector<Eigen::Isometry3d>& poses, const Clouds& clouds, real farthest,
                verdict& v, const std::string& what) {
  const device gpu;
  const auto model = on_host.on(gpu);
  tally_of_pairs expected;
  const auto counts =
      clearance::ask(host{}, on_host, poses, clouds, clearance::collect{tallied{farthest, expected.words}});
  auto words = gpu.make_scratch<unsigned long long>(2);
  gpu.stage(std::span<const unsigned long long>(tally_of_pairs{}.words), words.data());
  const auto seen = clearance::ask(gpu, model, poses, clouds, clearance::collect{tallied{farthest, words.data()}});
  const auto found = gpu.copy_out(words.data(), 2);
  const std::string all = what + ", within " + std::to_string(farthest);
  v.require(found[0] == expected.words[0] && found[1] == expected.words[1], all, ": other pairs than the host's, ",
            found[0], " and ", expected.words[0]);
  v.require(seen.seen == counts.seen && seen.valid == counts.valid && std::ranges::equal(seen.dropped, counts.dropped),
            all, ": other counts");
}

template <class V, class P>
void same_in_all_scenes() {
  verdict v;
  for (const auto& s : scenes<P>()) {
    const sources<P> all(s);
    const auto model = make_model<V>(s, {}, clearance::wrapped{});
    for (const real farthest : {real(0), real(0.3), real(5), clearance::infinity}) {
      same_pairs(model, s.poses, placed{all.span, s.cloud_pose}, farthest, v, s.name);
      same_pairs(model, s.poses, std::tuple(placed{all.raw, all.camera_pose}, placed{all.span, s.cloud_pose}), farthest,
                 v, s.name + ", two clouds");
    }
  }
}

}  // namespace

TEST_CASE("On a device every pair of a point and inner spheres within reach comes to an answer once") {
  same_in_all_scenes<clearance::sphere, inner_sphere>();
}
TEST_CASE("On a device every pair of a point and triangles within reach comes to an answer once") {
  same_in_all_scenes<clearance::aabb, triangle>();
}

TEST_CASE("Crowds, points inside solids, and more parts than a kernel takes give an answer the host's pairs",
          "[slow]") {
  verdict v;
  dice d(92);
  const auto box = [&] { return clearance::make_part<clearance::aabb>(clearance::close_mesh(shapes::cube(1))); };
  const clearance::model boxes{std::vector{box(), box()}};
  const auto crowd = d.points(300000, 2);
  same_pairs(boxes, {d.pose(0.5), d.pose(0.5)}, point_span(crowd), 0.5f, v, "boxes");
  auto on_faces =
      d.points(100000, 1);  // 0 away from triangles, and of every second face inside as well: then no triangle is named
  for (std::size_t i = 0; i < on_faces.size(); ++i)
    (i % 3 == 0 ? on_faces[i].x : i % 3 == 1 ? on_faces[i].y : on_faces[i].z) = i % 2 ? 1 : -1;
  same_pairs(boxes, std::vector(2, Eigen::Isometry3d::Identity()), point_span(on_faces), 0.5f, v, "faces of boxes");
  const scene<inner_sphere> s = many_parts(d);
  const auto some = d.points(5000, 1.5);
  same_pairs(make_model<clearance::sphere>(s, {}, clearance::wrapped{}), s.poses, point_span(some), 0.2f, v,
             "200 parts");
}

}  // namespace collect_test
