// SPDX-License-Identifier: BSD-3-Clause
// Extreme numbers on the device: the host's result in every bit, plain and prepared, cold, warm and moved.
#include "minimum/edge_scenes.hpp"
#include "solid/shapes.hpp"
#include "support/product_device.cuh"

#include <clearance/device.cuh>
#include <clearance/make_model.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/volume/obb.hpp>

#include <optional>

namespace edge_test {

using namespace testing;
using clearance::device, clearance::host, clearance::min_distance, clearance::placed, clearance::point_span;

namespace {

template <class Model>
void ask(const Model& on_host, std::vector<Eigen::Isometry3d> poses, const std::vector<vec3>& points,
         const Eigen::Isometry3d& pose, verdict& v, const std::string& what) {
  const device gpu;
  const auto model = on_host.on(gpu);
  const auto there = gpu.copy_in(std::span<const vec3>(points));
  const placed here{point_span(points), pose}, cloud{point_span(there.data(), points.size()), pose};
  using part_view = typename decltype(model.view())::part_type;
  std::optional<clearance::query<min_distance, device, part_view>> query;
  std::optional<clearance::query<clearance::min_distance_per_part, device, part_view>> per_part;
  if (poses.size() <= 128)
    query.emplace(gpu, model.view(), min_distance{}),
        per_part.emplace(gpu, model.view(), clearance::min_distance_per_part{});
  const auto same = [&](const std::string& when, int times) {
    const auto expected = ask(host{}, on_host, poses, here, min_distance{});
    const auto [robot, each] = clearance::ask(host{}, on_host, poses, here, clearance::min_distance_per_part{});
    v.require(same_result(ask(gpu, model, poses, cloud, min_distance{}), expected), what, ", plain, " + when,
              ": differs from the host's result");
    const auto [plain, own] = clearance::ask(gpu, model, poses, cloud, clearance::min_distance_per_part{});
    v.require(same_result(plain, robot) && std::ranges::equal(own, each, same_minimum), what,
              ", plain, by parts, " + when, ": differs");
    for (int k = 0; query && k < times; ++k) {
      const std::string at = ", " + when + std::to_string(k);
      v.require(same_result((*query)(poses, cloud), expected), what, at, ": differs from the host's result");
      const auto& found = (*per_part)(poses, cloud);
      v.require(same_result(found.all, robot), what, at, ": differs from the host's result by parts");
      v.require(std::ranges::equal(found.parts, each, same_minimum), what, at, ": some part's minimum differs");
    }
  };
  const auto first = poses;
  same("cold", 2);
  poses[0].translation().x() += 0.01, poses.back().translation().z() -= 5;
  same("moved", 2);
  poses = first;
  if (query) query->forget(), per_part->forget();
  same("cold again", 1);
}

struct write_points {
  endless_points from;
  vec3* to;
  CLEARANCE_HD void operator()(std::size_t i) const { to[i] = from[i].position; }
};

}  // namespace

TEST_CASE("Extreme numbers of parts, spheres, points and metres are exact on the device", "[slow]") {
  verdict v;
  for (const auto& s : edge_scenes()) {
    ask(edge_model(s), s.poses, s.points, s.cloud_pose, v, s.name);
    if (s.name == deep_scene)
      ask(edge_model(s, {.width = 2}), s.poses, s.points, s.cloud_pose, v, s.name + ", width 2");
  }
}

TEST_CASE("Crowds before very deep and very large trees are exact on the device: more pairs than a block keeps",
          "[slow]") {
  verdict v;
  for (auto s : edge_scenes()) {
    if (std::ranges::none_of(s.parts, [](const auto& p) { return p.size() == very_many; })) continue;
    for (std::size_t k = 0; s.points.size() < 500; ++k)
      s.points.push_back(clearance::scaled(real(k % 7) / 7, s.points[k]));
    ask(edge_model(s), s.poses, s.points, s.cloud_pose, v, s.name + ", crowded");
  }
}

TEST_CASE("Where every point is inside a solid the device says 0, at the first point, and collision") {
  dice d(79);
  verdict v;
  std::vector<decltype(clearance::make_part<clearance::obb>(clearance::close_mesh(shapes::cube(1))))> parts;
  for (const double half : {2.0, 1.0, 3.0})
    parts.push_back(clearance::make_part<clearance::obb>(clearance::close_mesh(shapes::cube(half))));
  const clearance::model model(std::move(parts));
  auto points = d.points(200000, 0.5);
  points[0].z = clearance::not_a_number;
  for (const double off : {0.0, 1000.0})
    ask(model, {d.pose(0.1), shifted(off, 0, 0) * d.pose(0.1), d.pose(0.1)}, points, shifted(0, 0, 0), v,
        "the second box " + std::to_string(off) + " m off");
  const device gpu;
  const auto there = model.on(gpu);
  clearance::query query(gpu, there, clearance::min_distance{});
  const auto r = query(std::vector{d.pose(0.1), d.pose(0.1), d.pose(0.1)}, points);
  CHECK((r.distance == 0 && r.point == 1 && r.part == 0 && r.state == clearance::state::collision && r.upper == 0 &&
         r.lower == 0));
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
