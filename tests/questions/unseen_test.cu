// SPDX-License-Identifier: BSD-3-Clause
// On a device, `unseen` says what it says on the host, bit for bit: pictures of all kinds, masked ones, several
// cameras.
#include "questions/unseen_scenes.hpp"

#include "support/counted_memory.cuh"
#include "support/held_stream.cuh"
#include "support/laws.hpp"

#include <clearance/device.cuh>

namespace unseen_test {

using namespace testing;
using clearance::device, clearance::host, clearance::unseen;

namespace {

template <class V, class P, class Pixel>
void check(unsigned seed) {
  verdict v;
  dice d(seed);
  const device gpu;
  for (int n = 0; n < 40; ++n) {
    const std::string what = "frame " + std::to_string(n);
    const double size = d.below(4) == 0 ? 30 : 1.5;
    const picture<Pixel> image(d, d.uniform(0, 1), size), other(d, 0.1, size);
    const seen_robot<P> robot(d, image.pose, size);
    const unseen q{some_room(d, size)};
    const auto model = robot.template model<V>(d.below(2) == 0 ? 4 : 8);
    const auto there = model.on(gpu);
    const auto labels = gpu.copy_in(std::span<const point_label>(image.labels)),
               others = gpu.copy_in(std::span<const point_label>(other.labels));
    using source = clearance::masked<decltype(image.image())>;
    const std::vector<placed<source>> on_host{{image.masked_image(), image.pose}, {other.masked_image(), other.pose}},
        on_device{{source{image.image(), labels.data()}, image.pose},
                  {source{other.image(), others.data()}, other.pose}};
    v.require(same_unseen(ask(gpu, there, robot.poses, on_device, q), ask(host{}, model, robot.poses, on_host, q)),
              what, ": two masked pictures");
    const placed one{image.image(), image.pose};
    v.require(same_unseen(ask(gpu, there, robot.poses, one, q), ask(host{}, model, robot.poses, one, q)), what,
              ": a picture");
  }
}

}  // namespace

TEST_CASE("Room behind pictures is as far from spheres on a device as on the host") {
  check<clearance::sphere, inner_sphere, std::uint16_t>(3221);
  check<clearance::obb, inner_sphere, float>(3222);
}
TEST_CASE("Room behind pictures is as far from triangles on a device as on the host") {
  check<clearance::obb, triangle, std::uint16_t>(3223);
  check<clearance::aabb, triangle, float>(3224);
}

TEST_CASE("On a device, what is seen and what is not, asked together, are the answers of both questions") {
  check_seen_and_unseen(device{}, 3241);
}

TEST_CASE("A table of rays, and solids that room begins in, say the same on a device") {
  verdict v;
  dice d(3225);
  const device gpu;
  const auto model = clearance::make_model<clearance::obb>(std::vector{clearance::close_mesh(shapes::cube(0.3))});
  const auto there = model.on(gpu);
  for (int n = 0; n < 40; ++n) {
    const picture<float> image(d, 0.3, 1.5);
    Eigen::Isometry3d pose = image.pose * d.pose(0.3);
    pose.translation() += image.pose.linear().col(2) * d.uniform(0, 1.5);
    const std::vector poses{pose};
    const auto rays = image.rays();
    const auto rays_there = gpu.copy_in(std::span<const clearance::ray>(rays));
    const unseen q{some_room(d, 1.5), std::min(image.half_pixel(), 0.24)};
    const auto lens = [&](const clearance::ray* table) {
      clearance::ray_image all(image.pixels.data(), table, image.width, image.height, image.scale);
      all.row = image.row;
      return placed{all, image.pose};
    };
    v.require(same_unseen(ask(gpu, there, poses, lens(rays_there.data()), q),
                          ask(host{}, model, poses, lens(rays.data()), q)),
              "frame ", n);
  }
}

TEST_CASE("A prepared question says in every frame what the host says, and a picture may lie on the device") {
  verdict v;
  dice d(3226);
  const device gpu;
  const picture<std::uint16_t> first(d, 0.2, 1.5);
  const seen_robot<inner_sphere> robot(d, first.pose, 1.5);
  const auto model = robot.model<clearance::sphere>(8);
  const auto there = model.on(gpu);
  const unseen q{some_room(d, 1.5)};
  clearance::query prepared(gpu, there, q);
  for (int n = 0; n < 10; ++n) {
    const picture<std::uint16_t> image(d, 0.2, 1.5);
    const auto pixels = gpu.copy_in(std::span<const std::uint16_t>(image.pixels));
    auto on_device = image.image();
    on_device.pixels = pixels.data();
    const auto expected = ask(host{}, model, robot.poses, placed{image.image(), image.pose}, q);
    v.require(same_unseen(prepared(robot.poses, placed{on_device, image.pose}), expected), "frame ", n, ", there");
    v.require(same_unseen(prepared(robot.poses, placed{image.image(), image.pose}), expected), "frame ", n, ", here");
  }
}

TEST_CASE("A prepared question takes device memory from the resource that it is given, once, and gives it back") {
  dice d(3227);
  const device gpu;
  const picture<std::uint16_t> image(d, 0.2, 1.5);
  const seen_robot<inner_sphere> robot(d, image.pose, 1.5);
  const auto model = robot.model<clearance::sphere>(8);
  const auto there = model.on(gpu);
  counted_memory memory;
  {
    clearance::query prepared(gpu, there, unseen{some_room(d, 1.5)}, &memory);
    const placed seen{image.image(), image.pose};
    const auto first = prepared(robot.poses, seen);
    CHECK(memory.held > image.image().bytes().size());  // the picture's copy, too
    const std::size_t asked = memory.asked;
    CHECK(same_unseen(prepared(robot.poses, seen), first));
    CHECK(memory.asked == asked);
  }
  CHECK(memory.held == 0);
}

}  // namespace unseen_test
