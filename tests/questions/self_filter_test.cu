// SPDX-License-Identifier: BSD-3-Clause
// On a device, the robot's own points and the minimum of the rest are the host's; both can be captured in a graph.
#include "support/brute_own.hpp"
#include "support/held_stream.cuh"
#include "support/product_device.cuh"

#include <clearance/device.cuh>
#include <clearance/make_model.hpp>
#include <clearance/questions/min_distance_filtered.hpp>
#include <clearance/questions/self_filter.hpp>
#include <clearance/robot/attached.hpp>
#include <clearance/volume/aabb.hpp>
#include <clearance/volume/sphere.hpp>

namespace self_filter_test {

using namespace testing;
using clearance::device, clearance::host, clearance::min_distance_filtered, clearance::placed, clearance::point_label,
    clearance::point_span, clearance::self_filter;

namespace {

template <class V, class P>
void all_scenes() {
  verdict v;
  const device gpu;
  for (const auto& s : scenes<P>()) {
    const sources<P> all(s);
    const auto model = make_model<V>(s, {}, clearance::wrapped{});
    const auto there = model.on(gpu);
    const auto each = [&](const auto& clouds, const std::string& what) {
      for (const double padding : {0.0, 0.02, 0.4}) {
        const clearance::self_filter options{.padding = {padding * s.size}};
        const auto a = min_distance_filtered(gpu, there, s.poses, clouds, options),
                   b = min_distance_filtered(host{}, model, s.poses, clouds, options);
        require_same(a.filter, b.filter, v, s.name + what);
        require_same(ask(gpu, there, s.poses, clouds, options), b.filter, v, s.name + what + ", alone");
        v.require(same_result(a.rest, b.rest), s.name + what, ": the rest differs");
      }
    };
    each(two_clouds(s), "");
    each(std::tuple(placed{all.raw, all.camera_pose}, placed{all.floats, s.cloud_pose}), ", a depth image and records");
  }
}

}  // namespace

TEST_CASE("On a device points of a robot of spheres are hidden as on the host") {
  all_scenes<clearance::sphere, inner_sphere>();
}
TEST_CASE("On a device points of a robot of triangles are hidden as on the host") {
  all_scenes<clearance::aabb, triangle>();
}

TEST_CASE("A crowd around three parts, one of them held by the others: filter and rest in a graph") {
  verdict v;
  own_stream stream;
  const device gpu{.stream = stream.handle};
  const auto s = crowd(98);
  const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
  const auto there = model.on(gpu);
  const clearance::model arm_here{std::vector{model.parts()[0], model.parts()[1]}},
      tool_here{std::vector{model.parts()[2]}};
  const auto arm = arm_here.on(gpu), tool = tool_here.on(gpu);
  const auto both = attach(gpu, arm, tool);
  const clearance::self_filter options{.padding = {0.05}};
  const auto expected = min_distance_filtered(host{}, model, s.poses, point_span(s.points), options);
  CHECK(expected.filter.counts.own > 10000);
  const auto found = min_distance_filtered(gpu, both, s.poses, point_span(s.points), options);
  require_same(found.filter, expected.filter, v, "attached");
  v.require(same_result(found.rest, expected.rest), "attached: the rest differs");

  const auto points = gpu.copy_in(std::span(s.points));
  const point_span cloud(points.data(), points.size());
  const auto labels = gpu.copy_in(std::span<const point_label>(std::vector<point_label>(s.points.size())));
  const auto counts =
      gpu.copy_in(std::span<const clearance::self_filter_counts>(std::vector<clearance::self_filter_counts>(1)));
  const auto result =
      gpu.copy_in(std::span<const clearance::min_distance_result>(std::vector<clearance::min_distance_result>(1)));
  const auto enqueue = [&] {
    clearance::enqueue(gpu, there, s.poses, cloud, options, {labels.data(), counts.data()});
    clearance::enqueue(gpu, there, s.poses, clearance::masked_clouds(cloud, labels.data()), clearance::min_distance{},
                       result.data());
  };
  enqueue();  // once, as loading a kernel is not for a graph
  gpu.wait();
  const captured_graph graph(stream.handle, enqueue);
  for (int frame = 0; frame < 3; ++frame) {
    check(cudaMemsetAsync(labels.data(), 0x55, labels.size(), stream.handle));
    check(cudaMemsetAsync(result.data(), 0x55, sizeof(clearance::min_distance_result), stream.handle));
    graph.launch();
    v.require(gpu.copy_out(labels) == expected.filter.labels, "frame ", frame, " of a graph: some label differs");
    v.require(same_result(gpu.copy_out(result)[0], expected.rest), "frame ", frame, " of a graph: the rest differs");
    v.require(gpu.copy_out(counts)[0].own == expected.filter.counts.own, "frame ", frame, " of a graph: counts");
  }
}

TEST_CASE(
    "A prepared filter of more parts than a kernel takes and of many clouds says in every frame what one call says") {
  verdict v;
  const device gpu;
  dice d(103);
  scene<inner_sphere> s = many_parts(d);
  const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
  const auto there = model.on(gpu);
  clearance::query filter(gpu, there, clearance::self_filter{});
  clearance::query here(host{}, model, clearance::self_filter{});
  const clearance::self_filter options{.padding = {0.05}};
  constexpr std::size_t count = 6 * 1001;
  const auto labels = gpu.copy_in(std::span<const point_label>(std::vector<point_label>(count)));
  const auto counts =
      gpu.copy_in(std::span<const clearance::self_filter_counts>(std::vector<clearance::self_filter_counts>(1)));
  for (int frame = 0; frame < 3; ++frame) {
    auto points = d.points(count, 1.5);
    points[17].x = points[2002].y = clearance::not_a_number;
    const auto points_there = gpu.copy_in(std::span<const vec3>(points));
    const auto in_six = [](const vec3* from) {
      std::vector<placed<point_span>> six;
      for (std::size_t c = 0; c < 6; ++c)
        six.push_back({point_span(from + c * 1001, 1001), Eigen::Isometry3d::Identity()});
      return six;
    };
    const auto expected = ask(host{}, model, s.poses, in_six(points.data()), options);
    filter.enqueue(s.poses, in_six(points_there.data()), options, {labels.data(), counts.data()});
    v.require(gpu.copy_out(labels) == expected.labels, "frame ", frame, ": some label differs");
    const auto found = gpu.copy_out(counts)[0];
    v.require(found.own == expected.counts.own && found.uncertain == expected.counts.uncertain &&
                  found.points.valid == expected.counts.points.valid && found.points.valid == count - 2,
              "frame ", frame, ": ", found.own, " own, and not ", expected.counts.own);
    std::vector<point_label> labels_here(count);
    clearance::self_filter_counts counts_here;
    here.enqueue(s.poses, in_six(points.data()), options, {labels_here.data(), &counts_here});
    v.require(labels_here == expected.labels && counts_here.own == expected.counts.own, "frame ", frame,
              ": the host's prepared one differs");
    require_same(filter(s.poses, in_six(points.data()), options), expected, v,
                 "waited for, frame " + std::to_string(frame));
    require_same(here(s.poses, in_six(points.data()), options), expected, v,
                 "waited for on the host, frame " + std::to_string(frame));
    v.require(expected.counts.own > 100 && expected.counts.own < count / 2, "frame ", frame, ": ", expected.counts.own,
              " are the robot's");
    s.poses[std::size_t(frame)] = d.pose(1);
  }
}

}  // namespace self_filter_test
