// SPDX-License-Identifier: BSD-3-Clause
// Everything enqueued returns while its stream is held, and can be captured; also with several clouds.
#include "support/brute_distances.hpp"
#include "support/brute_zones.hpp"
#include "support/held_stream.cuh"
#include "support/product_device.cuh"
#include "support/tallied.hpp"

#include <clearance/backends/device_buffer.cuh>
#include <clearance/backends/own_stream.cuh>
#include <clearance/device.cuh>
#include <clearance/questions/collect.hpp>
#include <clearance/questions/distances.hpp>
#include <clearance/questions/in_collision.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/questions/within.hpp>
#include <clearance/questions/zones.hpp>
#include <clearance/volume/sphere.hpp>

namespace enqueue_test {

using namespace testing;
using clearance::device, clearance::host, clearance::placed, clearance::point_span;

namespace {

/// A robot, two clouds of different kinds in device memory, and room for answers.
struct given {
  own_stream stream;
  device gpu{0, stream.handle};
  scene<inner_sphere> s = scenes<inner_sphere>()[1];
  sources<inner_sphere> all{s};
  decltype(make_model<clearance::sphere>(s, {}, clearance::wrapped{})) on_host =
      make_model<clearance::sphere>(s, {}, clearance::wrapped{});
  decltype(on_host.on(gpu)) model = on_host.on(gpu);
  device::buffer<std::byte> points = gpu.copy_in(all.span.bytes()), pixels = gpu.copy_in(all.raw.bytes());
  placed<point_span> cloud{all.span.at(points.data()), s.cloud_pose};
  std::tuple<placed<point_span>, placed<clearance::depth_image<std::uint16_t>>> clouds{
      cloud, {all.raw.at(pixels.data()), all.camera_pose}};
  clearance::pinned_buffer<clearance::min_distance_result> result{1, 0};
  clearance::pinned_buffer<clearance::part_minimum> minima{model.size(), 0};
  clearance::pinned_buffer<clearance::world_transform> poses{s.poses.size() + 1, 0};
  clearance::pinned_buffer<unsigned long long> words{2, 0};
  clearance::pinned_buffer<clearance::point_counts> counts{1, 0};
  clearance::query<clearance::min_distance, device, typename decltype(model)::view_type> query{
      gpu, model, clearance::min_distance{}};
  clearance::query<clearance::min_distance_per_part, device, typename decltype(model)::view_type> per_part{
      gpu, model, clearance::min_distance_per_part{}};

  given() {
    for (std::size_t k = 0; k < s.poses.size(); ++k) poses.data()[k] = clearance::world_transform(s.poses[k]);
    poses.data()[s.poses.size()] = clearance::world_transform(s.cloud_pose);
  }

  /// Calls `each(name, enqueue, clouds on the host)` for every way to enqueue a frame.
  template <class Each>
  void every_way(Each each) {
    const placed here{all.span, s.cloud_pose};
    const std::tuple both(here, placed{all.raw, all.camera_pose});
    const auto one = [&](const auto& there, const auto& same, const std::string& what) {
      each(
          "once" + what,
          [&] { clearance::enqueue(gpu, model, s.poses, there, clearance::min_distance{}, result.data()); }, same);
      each(
          "once, per_part" + what,
          [&] {
            clearance::enqueue(gpu, model, s.poses, there, clearance::min_distance_per_part{},
                               {result.data(), minima.data()});
          },
          same);
      each("prepared" + what, [&] { query.enqueue(s.poses, there, result.data()); }, same);
      each(
          "prepared, per_part" + what, [&] { per_part.enqueue(s.poses, there, {result.data(), minima.data()}); }, same);
    };
    one(cloud, here, "");
    one(clouds, both, " of two clouds");
    const auto* const of_cloud = poses.data() + s.poses.size();
    each("prepared, of poses there", [&] { query.enqueue(poses.data(), cloud.source, of_cloud, result.data()); }, here);
    each(
        "prepared, per_part, of poses there",
        [&] {
          per_part.enqueue(poses.data(), cloud.source, of_cloud,
                           clearance::min_distance_per_part::out{result.data(), minima.data()});
        },
        here);
  }
};

/// One block alone, so that it takes long. What follows may start at once.
__global__ void copy_slowly(const vec3* from, vec3* to, std::size_t n) {
  clearance::let_next_start();
  for (std::size_t i = threadIdx.x; i < n; i += blockDim.x) to[i] = from[i];
}

}  // namespace

TEST_CASE("Frames that follow at once see what was enqueued before them") {
  given g;
  verdict v;
  const std::size_t n = 1 << 16, frames = 24;
  std::vector<std::vector<vec3>> clouds(2);
  for (std::size_t i = 0; i < n; ++i) {
    const vec3 p = g.s.points[i % g.s.points.size()];
    clouds[0].push_back(p), clouds[1].push_back({p.x + real(3 * g.s.size), p.y, p.z});
  }
  std::vector<clearance::min_distance_result> expected;
  std::vector<device::buffer<vec3>> there;
  for (const auto& points : clouds) {
    expected.push_back(clearance::ask(host{}, g.on_host, g.s.poses, placed{point_span(points), g.s.cloud_pose},
                                      clearance::min_distance{}));
    there.push_back(g.gpu.copy_in(std::span<const vec3>(points)));
  }
  REQUIRE(!same_result(expected[0], expected[1]));
  const device::buffer<vec3> now(n, 0);
  clearance::pinned_buffer<clearance::min_distance_result> results(2 * frames, 0);
  clearance::query other(g.gpu, g.model, clearance::min_distance{});
  const auto enqueue = [&] {
    for (std::size_t f = 0; f < frames; ++f) {
      g.gpu.launch(copy_slowly, 1, 256, 0, static_cast<const vec3*>(there[f % 2].data()), now.data(), n);
      const placed cloud{point_span(now.data(), n), g.s.cloud_pose};
      g.query.enqueue(g.s.poses, cloud, results.data() + 2 * f);
      other.enqueue(g.s.poses, cloud, results.data() + 2 * f + 1);
    }
  };
  const auto look = [&](const std::string& what) {
    g.gpu.wait();
    for (std::size_t r = 0; r < 2 * frames; ++r)
      v.require(same_result(results.data()[r], expected[r / 2 % 2]), what, ": frame ", r / 2, " has seen another");
    std::fill_n(results.data(), 2 * frames, clearance::min_distance_result{});
  };
  enqueue();
  look("enqueued");
  const captured_graph graph(g.stream.handle, enqueue);
  graph.launch(), graph.launch();
  look("captured");
}

TEST_CASE("Every frame that is enqueued returns while its stream is held, and is right when it is released",
          "[concurrent]") {
  given g;
  verdict v;
  g.every_way([&](const std::string& name, auto enqueue, const auto& same) {
    const bool per_part = name.find("per_part") != std::string::npos;
    const auto expected =
        per_part ? clearance::ask(host{}, g.on_host, g.s.poses, same, clearance::min_distance_per_part{}).all
                 : clearance::ask(host{}, g.on_host, g.s.poses, same, clearance::min_distance{});
    enqueue();  // once, as loading a kernel may wait for everything
    g.gpu.wait();
    *g.result.data() = {};
    gate held(g.stream.handle);
    enqueue();
    v.require(cudaStreamQuery(g.stream.handle) == cudaErrorNotReady, name, ": it has waited");
    held.release();
    v.require(same_result(*g.result.data(), expected), name, ": differs from the host's result");
  });
}

TEST_CASE("An answer of one's own is enqueued without waiting, too", "[concurrent]") {
  given g;
  tally_of_pairs expected;
  const std::tuple both(placed{g.all.span, g.s.cloud_pose}, placed{g.all.raw, g.all.camera_pose});
  clearance::ask(host{}, g.on_host, g.s.poses, both, clearance::collect{tallied{1, expected.words}});
  const auto enqueue = [&] {
    clearance::enqueue(g.gpu, g.model, g.s.poses, g.clouds, clearance::collect{tallied{1, g.words.data()}},
                       {g.counts.data()});
  };
  enqueue();
  g.gpu.wait();
  g.words.data()[0] = g.words.data()[1] = 0;
  gate held(g.stream.handle);
  enqueue();
  CHECK(cudaStreamQuery(g.stream.handle) == cudaErrorNotReady);
  held.release();
  CHECK((g.words.data()[0] == expected.words[0] && g.words.data()[1] == expected.words[1]));

  clearance::query query(g.gpu, g.model, clearance::collect{tallied{1, g.words.data()}});
  g.words.data()[0] = g.words.data()[1] = 0;
  const auto counts = query(g.s.poses, both);
  CHECK((g.words.data()[0] == expected.words[0] && g.words.data()[1] == expected.words[1] &&
         counts.valid == g.counts.data()->valid));
  query.enqueue(g.s.poses, g.clouds, clearance::collect{tallied{1, g.words.data()}}, {g.counts.data()});
  g.gpu.wait();
  CHECK((g.words.data()[0] == 2 * expected.words[0] && g.words.data()[1] == 2 * expected.words[1] &&
         counts.valid == g.counts.data()->valid));
}

TEST_CASE("Several robots are asked in one call, each with its own result") {
  given g;
  auto shifted = g.s.poses;
  for (auto& pose : shifted) pose.translation() += Eigen::Vector3d(0.1, 0.2, -0.1);
  const std::vector poses{g.s.poses, shifted, g.s.poses};
  const std::vector robots(3, g.model.view());
  const std::tuple both(placed{g.all.span, g.s.cloud_pose}, placed{g.all.raw, g.all.camera_pose});  // to be copied
  const auto results = clearance::min_distance_per_robot(g.gpu, robots, poses, both);
  REQUIRE(results.size() == 3);
  for (std::size_t k = 0; k < 3; ++k)
    CHECK(same_result(results[k], clearance::ask(host{}, g.on_host, poses[k], both, clearance::min_distance{})));
}

TEST_CASE("Distances are enqueued without waiting, too", "[concurrent]") {
  given g;
  const std::tuple both(placed{g.all.span, g.s.cloud_pose}, placed{g.all.raw, g.all.camera_pose});
  const auto expected = clearance::ask(host{}, g.on_host, g.s.poses, both, clearance::distances{.d_max = 1});
  clearance::pinned_buffer<real> distance(expected.distance.size(), 0);
  const auto enqueue = [&] {
    return clearance::enqueue(g.gpu, g.model, g.s.poses, g.clouds, clearance::distances{1},
                              {{distance.data()}, g.counts.data()});
  };
  enqueue();
  g.gpu.wait();
  std::fill_n(distance.data(), distance.size(), real(-1));
  gate held(g.stream.handle);
  const auto certain = enqueue();
  CHECK(cudaStreamQuery(g.stream.handle) == cudaErrorNotReady);
  held.release();
  CHECK((certain.error.here == expected.certain.error.here && certain.slop == expected.certain.slop));
  verdict v;
  require_same({{distance.data(), distance.data() + distance.size()}, {}, {}, *g.counts.data(), certain}, expected, v,
               "enqueued");
}

TEST_CASE("Every frame that is enqueued by a prepared query can be captured and launched again") {
  given g;
  verdict v;
  g.every_way([&](const std::string& name, auto enqueue, const auto& same) {
    if (name.find("once") != std::string::npos) return;  // asks for memory
    const bool per_part = name.find("per_part") != std::string::npos;
    const auto expected =
        per_part ? clearance::ask(host{}, g.on_host, g.s.poses, same, clearance::min_distance_per_part{}).all
                 : clearance::ask(host{}, g.on_host, g.s.poses, same, clearance::min_distance{});
    enqueue();
    g.gpu.wait();
    const captured_graph graph(g.stream.handle, enqueue);
    for (int launch = 0; launch < 3; ++launch) {
      *g.result.data() = {};
      graph.launch();
      g.gpu.wait();
      v.require(same_result(*g.result.data(), expected), name, ", launch ", launch, ": differs from the host's result");
    }
  });
}

TEST_CASE("Questions that want memory for a call are enqueued without waiting, and can be captured and launched again",
          "[concurrent]") {
  given g;
  verdict v;
  const std::tuple both(placed{g.all.span, g.s.cloud_pose}, placed{g.all.raw, g.all.camera_pose});
  const clearance::zones thresholds{.thresholds = {0, 0.05 * g.s.size, 0.5 * g.s.size}};
  const std::vector margin{0.05 * g.s.size};
  const auto distances = clearance::ask(host{}, g.on_host, g.s.poses, both, clearance::distances{});
  const auto zones = clearance::ask(host{}, g.on_host, g.s.poses, both, thresholds);
  const auto collision = clearance::ask(host{}, g.on_host, g.s.poses, both, clearance::in_collision{margin});
  clearance::pinned_buffer<real> distance(distances.distance.size(), 0);
  clearance::pinned_buffer<clearance::zone> zone(zones.zones.size(), 0);
  clearance::pinned_buffer<clearance::collision_result> found(1, 0);

  const auto clear = [&] {
    std::fill_n(distance.data(), distance.size(), real(-1));
    std::fill_n(zone.data(), zone.size(), clearance::zone{.points = 77});
    *found.data() = {}, *g.counts.data() = {};
  };
  const auto look = [&](const std::string& what) {
    require_same({{distance.data(), distance.data() + distance.size()}, {}, {}, *g.counts.data(), distances.certain},
                 distances, v, what);
    require_same({zones.per_part, 1, {zone.data(), zone.data() + zone.size()}, *g.counts.data()}, zones, v, what);
    const auto& c = *found.data();
    v.require(c.state == collision.state && c.cloud == collision.cloud && c.point == collision.point &&
                  c.part == collision.part && c.counts.valid == collision.counts.valid &&
                  g.counts.data()->valid == zones.counts.valid,
              what, ": in_collision differs");
  };
  const auto enqueue = [&] {
    clearance::enqueue(g.gpu, g.model, g.s.poses, g.clouds, clearance::distances{},
                       {{distance.data()}, g.counts.data()});
    clearance::enqueue(g.gpu, g.model, g.s.poses, g.clouds, thresholds, {zone.data(), g.counts.data()});
    clearance::enqueue(g.gpu, g.model, g.s.poses, g.clouds, clearance::in_collision{margin}, found.data());
  };
  enqueue();
  g.gpu.wait();
  look("once");
  clear();
  {
    gate held(g.stream.handle);
    enqueue();
    v.require(cudaStreamQuery(g.stream.handle) == cudaErrorNotReady, "it has waited");
    held.release();
  }
  g.gpu.wait();
  look("on a stream that was held");

  const captured_graph graph(g.stream.handle, enqueue);
  for (int launch = 0; launch < 3; ++launch) {
    clear();
    graph.launch();
    g.gpu.wait();
    look("launch " + std::to_string(launch) + " of a graph");
  }
}

}  // namespace enqueue_test
