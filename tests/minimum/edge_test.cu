// SPDX-License-Identifier: BSD-3-Clause
// Extreme numbers on the device: the host's result in every bit, plain and prepared, cold, warm and moved.
#include "minimum/edge_cases.hpp"
#include "support/product_device.cuh"

#include <clearance/device.cuh>

namespace edge_test {

using namespace testing;
using clearance::device, clearance::host, clearance::min_distance, clearance::point_span;

namespace {

const auto ask_device = [](const auto& on_host, const auto& s, verdict& v, const std::string& what) {
  check_edge(device{}, on_host, s.poses, s.points, s.cloud_pose, v, what, nobody);
};

struct write_points {
  endless_points from;
  vec3* to;
  CLEARANCE_HD void operator()(std::size_t i) const { to[i] = from[i].position; }
};

}  // namespace

TEST_CASE("Extreme numbers of parts, spheres, points and metres are exact on the device", "[slow]") {
  verdict v;
  for (const auto& s : edge_scenes()) {
    ask_device(edge_model(s), s, v, s.name);
    if (s.name == deep_scene) ask_device(edge_model(s, {.width = 2}), s, v, s.name + ", width 2");
  }
}

TEST_CASE("Crowds before very deep and very large trees are exact on the device: more pairs than a block keeps",
          "[slow]") {
  verdict v;
  for (auto s : edge_scenes()) {
    if (std::ranges::none_of(s.parts, [](const auto& p) { return p.size() == very_many; })) continue;
    for (std::size_t k = 0; s.points.size() < 500; ++k)
      s.points.push_back(clearance::scaled(real(k % 7) / 7, s.points[k]));
    ask_device(edge_model(s), s, v, s.name + ", crowded");
  }
}

TEST_CASE("Where every point is inside a solid the device says 0, at the first point, and collision") {
  verdict v;
  check_all_inside(device{}, 200000, v, [](const auto&...) { return nobody; });
}

TEST_CASE("A hundred million points: the one that is near is found wherever it is", "[slow]") {
  constexpr std::size_t n = 100'000'000;
  std::size_t free = 0, total = 0;
  clearance::check_cuda(cudaMemGetInfo(&free, &total), "cudaMemGetInfo");
  if (free < n * sizeof(vec3) + (256u << 20)) {
    WARN("SKIPPED: a hundred million points need 1.5 GB of free device memory");
    return;
  }
  const device gpu;
  const auto s = small_robot();
  const auto on_host = edge_model(s);
  const auto model = on_host.on(gpu);
  const clearance::device_buffer<vec3> cloud(n, gpu.id);
  gpu.for_each(n, write_points{{n}, cloud.data()});
  const point_span all(cloud.data(), n);
  const auto put = [&](std::size_t i, vec3 p) {
    clearance::check_cuda(cudaMemcpy(cloud.data() + i, &p, sizeof p, cudaMemcpyHostToDevice), "cudaMemcpy");
  };
  const auto near = ask(host{}, on_host, s.poses, s.points, min_distance{});
  REQUIRE(near.distance < 2);
  clearance::query query(gpu, model, clearance::min_distance{});
  clearance::query per_part(gpu, model, clearance::min_distance_per_part{});
  verdict v;
  // Where floats stop counting, pieces and blocks end, and no point was before.
  for (const std::size_t at : {std::size_t(0), std::size_t(16'777'217), std::size_t(67'108'871), n / 2, n - 2, n - 1}) {
    const std::string what = "point " + std::to_string(at);
    put(at, endless_points::near());
    const auto plain = ask(gpu, model, s.poses, all, min_distance{});
    v.require(same_bits(plain.distance, near.distance) && plain.point == at && plain.part == near.part &&
                  plain.primitive == near.primitive,
              what);
    v.require(plain.seen == n && plain.valid == endless_points{n, at}.valid(), what, ": the counts");
    for (const char* when : {", before this one was there", ", warm"})
      v.require(same_result(query(s.poses, all), plain), what, when);
    const auto [robot, each] = clearance::ask(gpu, model, s.poses, all, clearance::min_distance_per_part{});
    const auto& found = per_part(s.poses, all);
    v.require(same_result(found.all, robot) && std::ranges::equal(found.parts, each, same_minimum), what, ": by parts");
    if (at == n - 1) {
      v.require(same_result(ask(host{}, on_host, s.poses, endless_points{n, at}, min_distance{}), plain), what,
                ": differs from the host's result");
      const point_span but_one(cloud.data() + 1, n - 1);
      v.require(same_result(query(s.poses, but_one), ask(gpu, model, s.poses, but_one, min_distance{})), what,
                ": unaligned");
      put(n / 2, endless_points::near());
      v.require(query(s.poses, all).point == n / 2, what, ": of two that are equally near the first is the answer");
    } else {
      put(at, endless_points{n}[at].position);
    }
  }
  clearance::check_cuda(cudaMemset(cloud.data(), 0xff, n * sizeof(vec3)), "cudaMemset");  // all bits set: no numbers
  const auto& [r, minima] = per_part(s.poses, all);
  CHECK((r.state == clearance::state::no_data && r.seen == n && r.valid == 0 &&
         r.dropped[int(clearance::drop_reason::not_finite)] == n));
  CHECK((minima[0].point == clearance::none && minima[2].point == clearance::none));
}

}  // namespace edge_test
