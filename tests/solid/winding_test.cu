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

struct ask {
  winding_view view;
  const vec3* points;
  int* windings;
  unsigned char* insides;
  __host__ __device__ void operator()(std::size_t i) const {
    windings[i] = view.winding(points[i]), insides[i] = view.inside(points[i]);
  }
};

/// How many points a device says something else of than the host; adds to `inside` those that are.
std::size_t different(const winding<>& w, const std::vector<vec3>& points, std::size_t& inside) {
  const device gpu;
  const auto there = w.on(gpu);
  const auto on_device = gpu.copy_in(std::span<const vec3>(points));
  auto windings = gpu.copy_in(std::span<const int>(std::vector<int>(points.size(), 99)));
  auto insides = gpu.copy_in(std::span<const unsigned char>(std::vector<unsigned char>(points.size(), 9)));
  gpu.for_each(points.size(), ask{there.view(), on_device.data(), windings.data(), insides.data()});
  gpu.wait();
  const auto winds = gpu.copy_out(windings);
  const auto is_inside = gpu.copy_out(insides);
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const unsigned char expected = w.view().inside(points[i]);
    wrong += winds[i] != w.view().winding(points[i]) || is_inside[i] != expected;
    inside += expected;
  }
  return wrong;
}

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
  std::size_t inside = 0;
  CHECK(different(w, points, inside) == 0);
  CHECK(inside > points.size() / 20);
}

TEST_CASE("What is inside damaged solids is the same on host and device, by floods too") {
  std::size_t wrong = 0, inside = 0, flooded = 0;
  for (unsigned k = 0; k < 132; ++k) {  // each kind of damage by itself, and each pair
    const testing::damaged_solid s = testing::damaged(k);
    const closed_mesh closed = close_mesh(s.mesh);
    flooded += !closed.enclosed.bits.empty();
    const auto w = make_winding(closed);
    std::vector<vec3> points;
    for (const Eigen::Vector3d& p : testing::probes(s, k, 500))
      points.push_back({real(p.x()), real(p.y()), real(p.z())});
    wrong += different(w, points, inside);
  }
  CHECK(wrong == 0);
  CHECK(inside > 10000);
  CHECK(flooded > 0);
}

}  // namespace winding_test
