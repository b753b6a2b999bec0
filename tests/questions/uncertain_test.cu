// SPDX-License-Identifier: BSD-3-Clause
// On a device, what is certain of a distance is what the host says, to the bit.
#include "questions/uncertain_scenes.hpp"

#include <clearance/device.cuh>
#include <clearance/make_model.hpp>
#include <clearance/points/depth_image.hpp>
#include <clearance/questions/unseen.hpp>
#include <clearance/volume/aabb.hpp>
#include <clearance/volume/sphere.hpp>

namespace uncertain_test {

using namespace testing;
using clearance::device, clearance::host, clearance::placed, clearance::point_span, clearance::uncertain;

namespace {

template <class V, class P>
void all_scenes() {
  verdict v;
  const device gpu;
  unsigned seed = 0;
  for (const auto& each : scenes<P>()) {
    const uncertain_scene<P> u(each, ++seed, 0.1);
    const auto& s = u.s;
    const auto model = make_model<V>(s, {}, clearance::wrapped{});
    const auto there = model.on(gpu);
    const auto radii = gpu.copy_in(std::span<const real>(u.radii));
    const auto points = gpu.copy_in(std::span<const vec3>(s.points));
    const certain_distance asked{u.parts};
    const auto ask_all = [&](const auto& on, const auto& robot, const auto& source) {
      return ask(on, robot, s.poses, std::vector{placed{source, s.cloud_pose}, placed{source, shifted(0.1, 0, 0)}},
                 asked);
    };
    const auto expected = ask_all(host{}, model, u.source());
    v.require(same_answer(ask_all(gpu, there, u.source(radii.data(), points.data())), expected), s.name);
    v.require(same_answer(ask_all(gpu, there, u.source(radii.data(), s.points.data())), expected), s.name,
              ": from host memory");
    const auto formula = [&](const auto& noise) {
      const uncertain here(point_span(s.points), noise, u.all);
      v.require(same_answer(ask_all(gpu, there, here), ask_all(host{}, model, here)), s.name, ": by a formula");
    };
    formula(clearance::kinect_noise{}), formula(clearance::stereo_noise{424, 0.05f, 0.08f});
    formula(clearance::tof_noise{0.004f, 0.001f}), formula(clearance::lidar_noise{0.02f, 0.001f});
  }
}

}  // namespace

TEST_CASE("On a device what is certain of spheres' distances is the host's") {
  all_scenes<clearance::sphere, inner_sphere>();
}
TEST_CASE("On a device what is certain of triangles' distances is the host's") {
  all_scenes<clearance::aabb, triangle>();
}

TEST_CASE("On a device several cameras of different kinds have radii of their own, and bad ones free nothing") {
  verdict v;
  const device gpu;
  dice d(9);
  scene<inner_sphere> s{"", {random_spheres(d, 30, 0.2), random_spheres(d, 30, 0.2)}, {d.pose(0.3), d.pose(0.3)}, {}};
  const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
  const auto there = model.on(gpu);
  std::vector<std::uint16_t> raw(160 * 120);
  for (auto& z : raw) z = std::uint16_t(d.uniform(0, 3000));
  std::vector<float> metres(64 * 48);
  for (float& z : metres) z = d.number(0.3, 3);
  const auto points = d.points(3000, 2);
  const clearance::depth_image<std::uint16_t> first(raw.data(), 160, 120, {150, 150, 80, 60});
  const clearance::depth_image<float> second(metres.data(), 64, 48, {60, 60, 32, 24});
  const auto look = [&](const auto& on, const auto& robot, const real* radii) {
    const std::tuple all{placed{uncertain(first, clearance::kinect_noise{}, {0.01, 0.002, 0, 0}), shifted(0, 0, -2)},
                         placed{uncertain(second, clearance::stereo_noise{60, 0.05f, 0.08f}, {0, 0, 2, 0.05})},
                         placed{uncertain(point_span(points), clearance::point_radii(radii, 3000))},
                         placed{point_span(points)}};
    return std::pair{ask(on, robot, s.poses, all, certain_distance{{{0.01, 0.001}, {0, 0.02}}}),
                     ask(on, robot, s.poses, std::get<1>(all), clearance::unseen{})};
  };
  std::vector<real> radii(3000, 0.03f);
  for (const real bad : {0.03f, clearance::not_a_number, -1.0f, infinity}) {
    radii[77] = bad;
    const auto copy = gpu.copy_in(std::span<const real>(radii));
    const auto [here, hides] = look(host{}, model, radii.data());
    const auto [on_gpu, hides_on_gpu] = look(gpu, there, copy.data());
    v.require(same_answer(on_gpu, here), "a device says something else");
    v.require(same_result(hides_on_gpu.all, hides.all), "a device hides something else");
    v.require(bad == 0.03f || (on_gpu.lower == 0 && on_gpu.state != clearance::state::free), "free");
  }
}

}  // namespace uncertain_test
