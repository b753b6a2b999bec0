// SPDX-License-Identifier: BSD-3-Clause
// With so many points that a device reads a round ahead, every kind of source that fetches gives the host's result in
// every bit.
#include "support/product_device.cuh"

#include <clearance/device.cuh>
#include <clearance/points/ray_image.hpp>
#include <clearance/points/slice.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/volume/sphere.hpp>

#include <cstring>

namespace ahead_test {

using namespace testing;
using clearance::device, clearance::host, clearance::placed, clearance::point_span;

namespace {

constexpr std::uint32_t width = 1024, height = 700;
constexpr std::size_t n = std::size_t(width) * height;

scene<inner_sphere> three_clumps() {
  scene<inner_sphere> s;
  dice d(71);
  for (int part = 0; part < 3; ++part) {
    s.parts.emplace_back();
    for (int k = 0; k < 60; ++k) s.parts.back().push_back({d.point(0.3f), d.number(0.01, 0.05)});
    s.poses.push_back(shifted(0.4 * part - 0.4, 0, 1.2) * d.pose(0.05));
  }
  return s;
}

/// A wall 3 m away with holes, and a few pixels that are near.
std::vector<std::uint16_t> depths() {
  dice d(72);
  std::vector<std::uint16_t> pixels(n);
  for (std::size_t i = 0; i < n; ++i)
    pixels[i] = i % 97 == 3 ? 0 : i % 1009 == 5 ? 65535 : std::uint16_t(3000 + d.below(400));
  for (int k = 0; k < 200; ++k) pixels[d.below(n)] = std::uint16_t(1500 + d.below(1000));
  return pixels;
}

}  // namespace

TEST_CASE("Points that are read ahead are the host's, from every kind of source", "[slow]") {
  const auto s = three_clumps();
  const auto on_host = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
  const device gpu;
  const auto model = on_host.on(gpu);
  verdict v;
  const auto same = [&](const auto& here, const auto& there, const std::string& what) {
    v.require(there.fetches(), what, ": it does not fetch");
    const auto pose = shifted(0.01, 0.02, 0);
    const auto expected = clearance::ask(host{}, on_host, s.poses, placed{here, pose}, clearance::min_distance{});
    clearance::query query(gpu, model, clearance::min_distance{});
    for (const char* when : {", cold", ", warm"})
      v.require(same_result(query(s.poses, placed{there, pose}), expected), what + when,
                ": differs from the host's result");
  };
  const auto raw = depths();
  std::vector<float> metres(n);
  for (std::size_t i = 0; i < n; ++i)
    metres[i] = raw[i] == 0 ? 0 : raw[i] == 65535 ? clearance::not_a_number : 0.001f * raw[i];
  const clearance::intrinsics camera{900, 910, 511.5, 349.5};
  const auto raw_there = gpu.copy_in(std::span<const std::uint16_t>(raw));
  const auto metres_there = gpu.copy_in(std::span<const float>(metres));
  clearance::depth_image<std::uint16_t> image(raw.data(), width, height, camera),
      image_there(raw_there.data(), width, height, camera);
  same(image, image_there, "16-bit image");
  clearance::depth_image<float> floats(metres.data(), width, height, camera),
      floats_there(metres_there.data(), width, height, camera);
  floats.farthest = floats_there.farthest = 3.2f;
  same(floats, floats_there, "float image");
  same(slice(image, 4, n - 3), slice(image_there, 4, n - 3), "a piece of an image");

  std::vector<clearance::ray> rays(n);
  for (std::size_t i = 0; i < n; ++i) rays[i] = {(float(i % width) - 511.5f) / 900, (float(i / width) - 349.5f) / 910};
  const auto rays_there = gpu.copy_in(std::span<const clearance::ray>(rays));
  same(clearance::ray_image<std::uint16_t>(raw.data(), rays.data(), width, height),
       clearance::ray_image<std::uint16_t>(raw_there.data(), rays_there.data(), width, height), "16-bit rays");
  same(clearance::ray_image<float>(metres.data(), rays.data(), width, height),
       clearance::ray_image<float>(metres_there.data(), rays_there.data(), width, height), "float rays");

  std::vector<vec3> points(n);
  for (std::size_t i = 0; i < n; ++i)
    points[i] = image[i].valid() ? image[i].position : vec3{clearance::not_a_number, 0, 0};
  const auto points_there = gpu.copy_in(std::span<const vec3>(points));
  for (const bool filtered : {false, true}) {
    const clearance::point_filter filter =
        filtered ? clearance::point_filter{.nearest = 1.8f, .farthest = 3.3f} : clearance::point_filter{};
    same(point_span(points, filter), point_span(points_there.data(), n, filter),
         filtered ? "filtered floats" : "floats");
  }
  const auto records = [&](auto scalar, std::uint32_t step, const char* what) {
    using number = decltype(scalar);
    std::vector<std::byte> bytes(n * step);
    for (std::size_t i = 0; i < n; ++i) {
      const number xyz[3] = {points[i].x, points[i].y, points[i].z};
      std::memcpy(bytes.data() + i * step, xyz, sizeof xyz);
    }
    const auto there = gpu.copy_in(std::span<const std::byte>(bytes));
    clearance::strided_points<number> here{
        .data = bytes.data(), .count = n, .step = step, .offset = {0, sizeof(number), 2 * sizeof(number)}};
    same(here, here.at(there.data()), what);
  };
  records(float(), 32, "records of floats");
  records(double(), 24, "records of doubles");
}

}  // namespace ahead_test
