// SPDX-License-Identifier: BSD-3-Clause
// On a device, questions with radii of points and parts say what the host says, to the bit.
#include "questions/uncertain_scenes.hpp"
#include "support/closed.hpp"
#include "support/configurations.hpp"

#include <clearance/device.cuh>
#include <clearance/make_model.hpp>
#include <clearance/motion_clearance.hpp>
#include <clearance/near_maps.hpp>
#include <clearance/questions/in_collisions.hpp>
#include <clearance/questions/min_distances_per_part.hpp>
#include <clearance/questions/unseen.hpp>
#include <clearance/questions/zones.hpp>
#include <clearance/volume/aabb.hpp>
#include <clearance/volume/obb.hpp>
#include <clearance/volume/sphere.hpp>

namespace radii_test {

using namespace testing;
using clearance::device, clearance::host, clearance::in_collision, clearance::in_collisions, clearance::min_distances,
    clearance::min_distances_per_part, clearance::placed, clearance::point_span, clearance::uncertain, clearance::zones;

namespace {

/// `here` and `there` are the same robot, `clouds` and `on_device` the same points.
template <class Here, class There, class Clouds, class OnDevice>
void check_all(const device& gpu, const Here& here, const There& there, const std::vector<Eigen::Isometry3d>& poses,
               const configurations& many, const Clouds& clouds, const OnDevice& on_device,
               const std::vector<double>& radii, double size, verdict& v, const std::string& what) {
  const auto both = [&](const char* which, const auto& question, const auto& where) {
    v.require(same_answer(ask(host{}, here, where, clouds, question), ask(gpu, there, where, on_device, question)),
              what, ": ", which);
  };
  for (const auto& its : {std::vector<double>{}, radii})
    for (const double margin : {0.0, 0.1 * size, size}) {
      both("in_collision", in_collision{{margin}, its}, poses);
      both("zones", zones{.thresholds = {margin, 2 * margin}, .radii = its}, poses);
      both("in_collisions", in_collisions{{margin}, its}, many);
      both("min_distances", min_distances{margin, its}, many);
      both("min_distances without a limit", min_distances{infinity, its}, many);
      both("min_distances_per_part", min_distances_per_part{margin == 0 ? double(infinity) : margin, its}, many);
    }
  clearance::query query(gpu, there, min_distances{});  // with radii, then without
  const std::vector<std::vector<double>> turns{radii, {}, radii};
  for (const auto& its : turns)
    v.require(same_answer(clearance::min_distances_result(query(many, on_device, {infinity, its})),
                          ask(host{}, here, many, clouds, min_distances{infinity, its})),
              what, ": a prepared question");
}

template <class V, class P>
void all_scenes() {
  verdict v;
  dice d(433);
  const device gpu;
  unsigned seed = 0;
  for (const auto& each : scenes<P>()) {
    const uncertain_scene<P> u(each, ++seed, 0.1);
    const auto& s = u.s;
    const auto model = make_model<V>(s, {}, clearance::wrapped{});
    const auto there = model.on(gpu);
    const auto radii = gpu.copy_in(std::span<const real>(u.radii));
    const auto points = gpu.copy_in(std::span<const vec3>(s.points));
    const auto poses = configurations_of(s, d, 5);
    const placed here{u.source(), s.cloud_pose}, on_gpu{u.source(radii.data(), points.data()), s.cloud_pose};
    check_all(gpu, model, there, s.poses, poses, here, on_gpu, u.radii_of_parts(), s.size, v, s.name);
    const auto several = [&](const auto& cloud, const vec3* at) {
      return std::tuple(placed{point_span(at, s.points.size()), shifted(0.3, 0, 0) * s.cloud_pose}, cloud,
                        placed{uncertain(point_span(at, s.points.size()), clearance::tof_noise{0.01f, 0.001f}),
                               shifted(100, 0, 0) * s.cloud_pose});
    };
    check_all(gpu, model, there, s.poses, poses, several(here, s.points.data()), several(on_gpu, points.data()),
              u.radii_of_parts(), s.size, v, s.name + ", several");
    const auto fields = clearance::with_fields(host{}, model, {1 << 14});
    check_all(gpu, fields.model, fields.model.on(gpu), s.poses, poses, here, on_gpu, u.radii_of_parts(), s.size, v,
              s.name + ", by fields");
  }
}

}  // namespace

TEST_CASE("On a device spheres' questions with radii say what the host says") {
  all_scenes<clearance::sphere, inner_sphere>();
}
TEST_CASE("On a device triangles' questions with radii say what the host says") {
  all_scenes<clearance::aabb, triangle>();
}

TEST_CASE("On a device solids' questions with radii say what the host says, for few configurations and for many") {
  verdict v;
  dice d(12);
  const device gpu;
  const auto closed = closed_scene(12);
  const auto model = clearance::make_model<clearance::obb>(closed.meshes);
  const auto there = model.on(gpu);
  for (int round = 0; round < 4; ++round) {
    const auto points = d.points(round < 2 ? 60 : 20000, 1);
    std::vector<real> of_points;
    for (std::size_t i = 0; i < points.size(); ++i) of_points.push_back(d.below(3) == 0 ? 0 : d.number(0, 0.1));
    const auto radii = gpu.copy_in(std::span<const real>(of_points));
    const auto cloud = [&](const real* its) {
      return placed{uncertain{point_span(points), clearance::point_radii(its, points.size())}, d.pose(0)};
    };
    const auto here = cloud(of_points.data());
    auto on_gpu = cloud(radii.data());
    on_gpu.pose = here.pose;
    configurations poses;
    for (int c = 0; c < (round % 2 == 0 ? 8 : 600); ++c)
      for (const auto& pose : closed.poses) poses.push_back(d.pose(0.7) * pose);
    check_all(gpu, model, there, closed.poses, poses, here, on_gpu, {0.01, 0, 0.03}, 0.3, v,
              "round " + std::to_string(round));
  }
}

TEST_CASE("On a device motions and hidden room with radii are the host's") {
  verdict v;
  dice d(5);
  const device gpu;
  for (int round = 0; round < 5; ++round) {
    scene<inner_sphere> s{"", {}, {}, d.points(3000, 2)};
    for (int k = 0; k < 3; ++k) {
      s.parts.push_back(random_spheres(d, 20, 0.2, 0.03));
      s.poses.push_back(shifted(d.uniform(-0.3, 0.3), d.uniform(-0.3, 0.3), d.uniform(0.5, 1.5)));
    }
    std::vector<Eigen::Isometry3d> to;
    for (const auto& pose : s.poses) to.push_back(shifted(0.3, 0.1, -0.2) * pose);
    const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
    const auto there = model.on(gpu);
    const clearance::straight_motion motion(s.poses, to);
    const uncertain vague(point_span(s.points), clearance::lidar_noise{0.005f, 0.002f});
    const std::vector<double> radii{0.01, 0, 0.03};
    const clearance::motion_clearance_options asked{.tolerance = 0.01, .radii = radii};
    const auto here = motion_clearance(host{}, model, motion, placed{vague}, asked),
               on_gpu = motion_clearance(gpu, there, motion, placed{vague}, asked);
    v.require(same_bits(here.lower, on_gpu.lower) && same_bits(here.upper, on_gpu.upper) &&
                  here.queries == on_gpu.queries && here.state == on_gpu.state && here.part == on_gpu.part,
              "round", round, ": a motion");
    std::vector<float> pixels(160 * 120);
    for (float& z : pixels) z = d.below(20) == 0 ? 0 : d.number(1, 3);
    const clearance::depth_image<float> image(pixels.data(), 160, 120, {150, 150, 80, 60});
    const clearance::unseen hides{.edges = true, .radii = radii};
    const auto hidden = [&](const auto& on, const auto& robot) {
      return ask(on, robot, s.poses, std::vector{placed{image}, placed{image, shifted(0.2, 0, 0)}}, hides);
    };
    const auto a = hidden(host{}, model), b = hidden(gpu, there);
    v.require(same_result(a.all, b.all), "round", round, ": hidden room");
    for (std::size_t k = 0; k < a.parts.size(); ++k)
      v.require(same_bits(a.parts[k].lower, b.parts[k].lower) && same_bits(a.parts[k].to_edge, b.parts[k].to_edge),
                "round", round, ": part", k);
  }
}

}  // namespace radii_test
