// SPDX-License-Identifier: BSD-3-Clause
// Packets that walk by tangents find what the host finds, bit for bit: near and far, warm and cold, inside and outside.
#include "scan/tangent_scenes.hpp"
#include "support/product_device.cuh"

#include <clearance/device.cuh>

namespace tangents_test {

using namespace testing;
using clearance::device, clearance::distances, clearance::host, clearance::placed, clearance::point_span;

namespace {

const auto check = [](const auto& s, const auto& model, const std::vector<vec3>& points, const std::string& what,
                      const auto&) {
  verdict v;
  const device gpu;
  const auto there = model.on(gpu);
  const auto cloud = gpu.copy_in(std::span<const vec3>(points));
  const clearance::device_buffer<real> distance(points.size(), gpu.id);
  const clearance::device_buffer<std::uint32_t> part(points.size(), gpu.id), primitive(points.size(), gpu.id);
  const clearance::device_buffer<clearance::point_counts> counts(1, gpu.id);
  for (const real d_max : {clearance::infinity, real(0.3), real(0), real(-0.01)}) {
    const auto expected = ask(host{}, model, s.poses, placed{point_span(points), s.cloud_pose}, distances{d_max, true});
    for (const bool remembers : {false, true}) {
      clearance::pointwise::device_points<typename decltype(there)::view_type> walk(gpu, there.view(), nullptr,
                                                                                    remembers);
      walk.by_tangents = true;
      for (int frame = 0; frame < (remembers ? 3 : 1); ++frame) {
        walk.enqueue(s.poses, placed{point_span(cloud.data(), points.size()), s.cloud_pose},
                     {distance.data(), part.data(), primitive.data()}, d_max, counts.data(),
                     clearance::frames::as_it_is{});
        clearance::point_distances found;
        found.distance = gpu.copy_out(distance), found.part = gpu.copy_out(part),
        found.primitive = gpu.copy_out(primitive), found.counts = gpu.copy_out(counts)[0];
        require_same(found, expected, v,
                     what + " within " + std::to_string(d_max) + ", frame " + std::to_string(frame));
      }
    }
  }
};

}  // namespace

TEST_CASE("By tangents to inner spheres, in every volume") { by_tangents_to_spheres(check); }
TEST_CASE("By tangents to triangles, in every volume") { by_tangents_to_triangles(check); }
TEST_CASE("By tangents to solids that overlap and repeat, from inside and on their faces") {
  by_tangents_to_solids(check);
}
TEST_CASE("By tangents to more parts than a warp has lanes, and than a kernel takes", "[slow]") {
  by_tangents_to_many_parts(check);
}

TEST_CASE("A million points in rows, and a picture, walk by tangents of themselves") {
  verdict v;
  const device gpu;
  const auto boxes = clearance::make_model<clearance::obb>(std::vector(2, clearance::close_mesh(shapes::cube(1))));
  Eigen::Isometry3d away = Eigen::Isometry3d::Identity();
  away.translation() << 2, 1, 0.5;
  const std::vector poses{Eigen::Isometry3d(Eigen::Isometry3d::Identity()), away};
  const auto there = boxes.on(gpu);
  std::vector<vec3> wall;
  for (int i = 0; i < 1024; ++i)
    for (int j = 0; j < 1024; ++j)
      wall.push_back({1.5f + (i / 64 % 2 == 0 ? 0.3f : 0), 0.004f * real(i - 512), 0.004f * real(j - 512)});
  require_same(ask(gpu, there, poses, point_span(wall), distances{clearance::infinity, true}),
               ask(host{}, boxes, poses, point_span(wall), distances{clearance::infinity, true}), v, "a wall");
  std::vector<float> depth;
  for (const vec3 p : wall) depth.push_back(p.x);
  const clearance::depth_image image(depth.data(), 1024, 1024, clearance::intrinsics{500, 500, 512, 512});
  require_same(ask(gpu, there, poses, image, distances{clearance::infinity, true}),
               ask(host{}, boxes, poses, image, distances{clearance::infinity, true}), v, "a picture");
}

}  // namespace tangents_test
