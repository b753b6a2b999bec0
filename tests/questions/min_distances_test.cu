// SPDX-License-Identifier: BSD-3-Clause
// On a device, the least distances of many configurations are the host's, in every bit.
#include "minimum/edge_scenes.hpp"
#include "solid/shapes.hpp"
#include "support/brute_pairs.hpp"
#include "support/configurations.hpp"

#include <clearance/device.cuh>
#include <clearance/make_model.hpp>
#include <clearance/questions/in_collisions.hpp>
#include <clearance/questions/min_distances.hpp>
#include <clearance/questions/min_distances_per_part.hpp>
#include <clearance/volume/aabb.hpp>
#include <clearance/volume/obb.hpp>
#include <clearance/volume/sphere.hpp>

namespace min_distances_test {

using namespace testing;
using clearance::device, clearance::host, clearance::infinity, clearance::min_distances, clearance::placed,
    clearance::point_span, clearance::state;

namespace {

void require_results(const std::vector<clearance::min_distance_result>& found,
                     const std::vector<clearance::min_distance_result>& expected, verdict& v, const std::string& what) {
  v.require(found.size() == expected.size(), what, ": another number of results");
  for (std::size_t c = 0; c < found.size() && c < expected.size(); ++c)
    v.require(same_result(found[c], expected[c]), what, ", configuration", c, ": ", found[c].distance, " at",
              found[c].point, ",", found[c].part, ",", found[c].primitive, " instead of", expected[c].distance, " at",
              expected[c].point, ",", expected[c].part, ",", expected[c].primitive);
}

template <class Model, class Clouds>
void check(const Model& model, const configurations& poses, const Clouds& clouds, double size, verdict& v,
           const std::string& what) {
  const device gpu;
  const auto there = model.on(gpu);
  clearance::query query(gpu, there, clearance::min_distances{});
  query.place(poses);
  for (const double d_max : {-0.05, 0.0, 0.2, double(infinity)}) {
    const clearance::min_distances options{real(d_max * size)};
    const auto expected = ask(host{}, model, poses, clouds, options);
    require_results(query(clouds, options).of, expected.of, v,
                    what + ", prepared, d_max " + std::to_string(options.d_max));
    if (d_max > 0)
      require_results(ask(gpu, there, poses, clouds, options).of, expected.of, v,
                      what + ", d_max " + std::to_string(options.d_max));
  }
  clearance::query states(gpu, there, clearance::in_collisions{});
  states.place(poses);
  for (const double margin : {-0.05, 0.0, 0.02, 0.3}) {
    std::vector<double> margins(view_of(model).size(), margin * size);
    margins[0] *= 3;
    const auto expected = clearance::ask(host{}, model, poses, clouds, clearance::in_collisions{margins});
    const auto& found = states(clouds, {margins});
    v.require(found.of == expected.of, what, ", margin", margin, ": other states");
    v.require(found.counts.valid == expected.counts.valid && found.counts.seen == expected.counts.seen, what,
              ": other counts");
    if (margin > 0.1)
      v.require(clearance::ask(gpu, there, poses, clouds, clearance::in_collisions{margins}).of == expected.of, what,
                ", in one call: other states");
  }
}

/// Each part's, prepared, enqueued and in one call; the cloud in host memory, too.
template <class Model>
void check_parts(const Model& model, const configurations& poses, const std::vector<vec3>& points,
                 const Eigen::Isometry3d& pose, double size, verdict& v, const std::string& what) {
  const device gpu;
  const auto there = model.on(gpu);
  clearance::query query(gpu, there, clearance::min_distances_per_part{});
  clearance::query enqueued(gpu, there, clearance::min_distances_per_part{});
  enqueued.place(poses);
  const auto copy = gpu.copy_in(std::span<const vec3>(points));
  const placed clouds{point_span(points), pose}, cloud{point_span(copy.data(), copy.size()), pose};
  for (const double d_max : {0.2, double(infinity)}) {
    const clearance::min_distances_per_part options{real(d_max * size)};
    const auto expected = clearance::ask(host{}, model, poses, clouds, options);
    require_results(query(poses, clouds, options).all, expected.all, v,
                    what + ", each part, prepared, d_max " + std::to_string(options.d_max));
    require_results(gpu.copy_out(enqueued.enqueue(cloud, options), poses.size()), expected.all, v,
                    what + ", each part, enqueued, d_max " + std::to_string(options.d_max));
    require_results(clearance::ask(gpu, there, poses, clouds, options).all, expected.all, v,
                    what + ", each part, d_max " + std::to_string(options.d_max));
  }
}

template <class V, class P>
void all_scenes(std::uint32_t width) {
  verdict v;
  dice d(511);
  for (const auto& s : scenes<P>()) {
    const sources<P> all(s);
    const auto poses = configurations_of(s, d);
    const auto model = make_model<V>(s, {.width = width}, clearance::wrapped{});
    check(model, poses, placed{all.span, s.cloud_pose}, s.size, v, s.name);
    check_parts(model, poses, s.points, s.cloud_pose, s.size, v, s.name);
    const auto several =
        std::tuple(placed{all.raw, all.camera_pose}, std::vector(2, placed{all.doubles, s.cloud_pose}));
    check(model, poses, several, s.size, v, s.name + ", several clouds");
  }
}

/// A scene, dice, its robot of spheres, and so many configurations of that.
auto configurations_in_a_crowd(unsigned seed, std::size_t count) {
  auto s = crowd(seed);
  dice d(seed + 1);
  auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
  auto poses = configurations_of(s, d, count);
  return std::tuple(std::move(s), d, std::move(model), std::move(poses));
}

}  // namespace

TEST_CASE("Least distances of many configurations on a device are the host's") {
  all_scenes<clearance::sphere, inner_sphere>(8);
  all_scenes<clearance::aabb, triangle>(2);
}

TEST_CASE("So they are of robots and clouds of extreme numbers, on a device") {
  verdict v;
  dice d(512);
  for (const auto& s : edge_scenes()) {
    const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
    check(model, configurations_of(s, d, 4), placed{point_span(s.points), s.cloud_pose}, s.size, v, s.name);
  }
}

TEST_CASE("A trajectory among a crowd is watched on a device, from frame to frame") {
  verdict v;
  auto s = crowd(513);
  const device gpu;
  const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
  configurations poses;
  for (int c = 0; c < 600; ++c)
    for (const auto& pose : s.poses) poses.push_back(shifted(0.002 * c, 0, 0) * pose);
  const auto there = model.on(gpu);
  clearance::query query(gpu, there, clearance::min_distances{});
  query.place(poses);
  clearance::query on_host(host{}, model, clearance::min_distances{});
  dice d(514);
  for (int frame = 0; frame < 3; ++frame) {
    for (vec3& p : s.points) p.x += d.number(-0.001, 0.001);
    if (frame == 2) s.points.resize(1000);
    const auto expected = on_host(poses, point_span(s.points)).of;
    require_results(query(point_span(s.points)).of, expected, v, "frame " + std::to_string(frame));
    query.begin_placed(point_span(s.points), min_distances{});
    require_results(query.finish().of, expected, v, "frame " + std::to_string(frame) + ", begun");
  }
}

TEST_CASE("An image's tree is made of its pixels, whatever its size, and asked the same") {
  verdict v;
  auto [s, d, model, poses] = configurations_in_a_crowd(516, 12);
  for (const std::uint32_t width : {1u, 3u, 64u, 65u, 320u})
    for (const std::uint32_t height : {1u, 63u, 130u}) {
      std::vector<std::uint16_t> pixels(width * height);
      for (std::size_t i = 0; i < pixels.size(); ++i)
        pixels[i] = i % 13 == 5 ? 0 : std::uint16_t(900 + 300 * std::sin(double(i % width) / 40) + d.number(0, 3));
      const clearance::depth_image image(pixels.data(), width, height, {260, 260, 0.5 * width, 0.5 * height});
      const std::string what = std::to_string(width) + " x " + std::to_string(height);
      check(model, poses, placed{image, shifted(0, 0, -1.5)}, 1, v, what);
      if (width == 65)
        check(model, poses, std::tuple(placed{image, shifted(0, 0, -1.5)}, point_span(s.points)), 1, v,
              what + " and points");
    }
}

TEST_CASE("A tree of a few hundred thousand points has all its levels") {
  verdict v;
  auto [s, d, model, poses] = configurations_in_a_crowd(518, 6);
  s.points = d.points(200000, 2);
  const device gpu;
  const point_span cloud(s.points);
  require_results(ask(gpu, model.on(gpu), poses, cloud, min_distances{}).of,
                  ask(host{}, model, poses, cloud, min_distances{}).of, v, "many points");
}

TEST_CASE("Points inside solids are 0 away of every configuration, on a device") {
  verdict v;
  dice d(515);
  for (const double tolerance : {0.0, 0.3, 2.0}) {
    const auto model = clearance::make_model<clearance::obb>(std::vector(2, clearance::close_mesh(shapes::cube(1))),
                                                             clearance::part_options{.tolerance = tolerance});
    configurations poses;
    for (int c = 0; c < 60; ++c)
      for (int k = 0; k < 2; ++k) poses.push_back(d.pose(0.1 * c));
    for (const std::size_t points : {3u, 40u, 3000u})
      check(model, poses, d.points(points, 3), 1, v, std::to_string(points) + " points");
  }
}

TEST_CASE("What is no batch is refused on a device, and a pose that is not rigid stops a robot") {
  const auto s = scenes<inner_sphere>()[0];
  const device gpu;
  const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{}).on(gpu);
  const point_span cloud(s.points);
  configurations poses = s.poses;
  poses.insert(poses.end(), s.poses.begin(), s.poses.end());
  CHECK(ask(gpu, model, configurations{}, cloud, min_distances{}).of.empty());
  CHECK_THROWS_WITH(ask(gpu, model, std::span(poses).first(4), cloud, min_distances{}),
                    "clearance: 4 poses are no whole configurations of 3 parts");
  CHECK_THROWS_AS(ask(gpu, model, poses, cloud, min_distances{clearance::not_a_number}), std::invalid_argument);
  poses[4].linear() *= 1.5;
  CHECK_THROWS_WITH(
      ask(gpu, model, poses, cloud, min_distances{}),
      Catch::Matchers::StartsWith("clearance: the pose of configuration 1's part 1 is not rigid: its axes"));
  const auto points = gpu.copy_in(std::span<const vec3>(s.points));
  clearance::query query(gpu, model, clearance::min_distances{});
  query.place(poses);
  const auto r = gpu.copy_out(query.enqueue(point_span(points.data(), points.size()), min_distances{0.1f}), 2);
  CHECK((r[1].state == state::possible && r[1].distance != r[1].distance && r[1].lower == 0));
  CHECK((r[0].state != state::no_data && (r[0].distance == infinity || r[0].part != clearance::none)));
  CHECK_THROWS_WITH(
      clearance::ask(gpu, model, poses, cloud, clearance::in_collisions{{0.1}}),
      Catch::Matchers::StartsWith("clearance: the pose of configuration 1's part 1 is not rigid: its axes"));
  clearance::query parts(gpu, model, clearance::min_distances_per_part{});
  parts.place(poses);
  const auto each = gpu.copy_out(parts.enqueue(point_span(points.data(), points.size())), 6);
  for (int i = 0; i < 6; ++i) CHECK((each[i].state == state::possible && each[i].lower == 0) == (i == 4));
  clearance::query ask(gpu, model, clearance::in_collisions{});
  ask.place(poses);
  CHECK((gpu.copy_out(ask.enqueue(point_span(points.data(), points.size()), clearance::in_collisions{{1e9}}), 2) ==
         std::vector{state::collision, state::possible}));
  CHECK_THROWS_AS(ask(cloud, {{clearance::not_a_number}}), std::invalid_argument);
  CHECK(clearance::ask(gpu, model, configurations{}, cloud, clearance::in_collisions{}).of.empty());
}

TEST_CASE("A robot without parts has no configurations, on a device") {
  using view = clearance::part_view<clearance::bvh_view<clearance::sphere, inner_sphere>>;
  const clearance::model_view<view> nothing{nullptr, {}, 0, 0};
  CHECK(ask(device{}, nothing, configurations{}, std::vector<vec3>{{1, 2, 3}}, min_distances{}).of.empty());
  CHECK(ask(device{}, nothing, configurations{}, std::vector<vec3>{{1, 2, 3}}, clearance::min_distances_per_part{})
            .all.empty());
  CHECK_THROWS_AS(ask(device{}, nothing, configurations(2, Eigen::Isometry3d::Identity()), std::vector<vec3>{{1, 2, 3}},
                      min_distances{}),
                  std::invalid_argument);
}

}  // namespace min_distances_test
