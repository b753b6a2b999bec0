// SPDX-License-Identifier: BSD-3-Clause
#include "solid/damaged.hpp"
#include "support/catch.hpp"

#include <clearance/backends/device.cuh>
#include <clearance/solid/close_mesh.hpp>
#include <clearance/solid/winding.hpp>

#include <random>

namespace winding_test {

using namespace clearance;

namespace {

struct ask_inside {
  winding_view view;
  const vec3* points;
  unsigned char* answers;
  __host__ __device__ void operator()(std::size_t i) const { answers[i] = view.inside(points[i]); }
};

struct ask {
  winding_view view;
  const vec3* points;
  int* answers;
  __host__ __device__ void operator()(std::size_t i) const { answers[i] = view.winding(points[i]); }
};

}  // namespace

TEST_CASE("winding numbers are the same on host and device, in the surface and in line with its corners too") {
  std::mt19937 random(1);
  auto mesh = shapes::merged(shapes::globe({0, 0, 0}, 1, 40, 60), shapes::box({0.1, 0.2, 0.3}, {1.5, 1.4, 1.3}));
  for (int i = 0; i < 200; ++i) {  // random triangles, closed by caps
    for (int k = 0; k < 3; ++k) mesh.vertices.emplace_back(Eigen::Vector3d::Random());
    const auto n = std::uint32_t(mesh.vertices.size());
    mesh.triangles.push_back({n - 3, n - 2, n - 1});
  }
  const auto w = make_winding(close_mesh(mesh));
  std::uniform_real_distribution<float> unit(0, 1);
  std::vector<vec3> points(1 << 20);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto& t = w.triangles[random() % w.triangles.size()];
    float p[3], u = unit(random), v = (1 - u) * unit(random);
    for (int k = 0; k < 3; ++k) {
      const float on = t.v[0][k] + u * (t.v[1][k] - t.v[0][k]) + v * (t.v[2][k] - t.v[0][k]);
      p[k] = i % 3 == 0 ? on : w.grid.low[k] + unit(random) * (w.grid.high[k] - w.grid.low[k]);
    }
    if (i % 3 == 1) p[1] = t.v[0][1], p[2] = t.v[0][2];
    points[i] = {p[0], p[1], p[2]};
  }
  const device gpu;
  const auto there = w.on(gpu);
  const auto on_device = gpu.copy_in(std::span<const vec3>(points));
  auto answers = gpu.copy_in(std::span<const int>(std::vector<int>(points.size(), 99)));
  gpu.for_each(points.size(), ask{there.view(), on_device.data(), answers.data()});
  gpu.wait();
  const std::vector<int> got = gpu.copy_out(answers);
  std::size_t different = 0, inside = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const int expected = w.view().winding(points[i]);
    different += got[i] != expected;
    inside += expected != 0;
  }
  CHECK(different == 0);
  CHECK(inside > points.size() / 20);
}

TEST_CASE("What is inside damaged solids is the same on host and device, by floods too") {
  std::size_t different = 0, inside = 0, flooded = 0;
  for (unsigned k = 0; k < 132; ++k) {  // each kind of damage by itself, and each pair
    const testing::damaged_solid s = testing::damaged(k);
    const closed_mesh closed = close_mesh(s.mesh);
    flooded += !closed.enclosed.bits.empty();
    const auto w = make_winding(closed);
    std::vector<vec3> points;
    for (const Eigen::Vector3d& p : testing::probes(s, k, 500))
      points.push_back({real(p.x()), real(p.y()), real(p.z())});
    const device gpu;
    const auto there = w.on(gpu);
    const auto on_device = gpu.copy_in(std::span<const vec3>(points));
    auto answers = gpu.copy_in(std::span<const unsigned char>(std::vector<unsigned char>(points.size(), 9)));
    gpu.for_each(points.size(), ask_inside{there.view(), on_device.data(), answers.data()});
    gpu.wait();
    const std::vector<unsigned char> got = gpu.copy_out(answers);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const bool expected = w.view().inside(points[i]);
      different += (got[i] != 0) != expected || got[i] > 1;
      inside += expected;
    }
  }
  CHECK(different == 0);
  CHECK(inside > 10000);
  CHECK(flooded > 0);
}

}  // namespace winding_test
