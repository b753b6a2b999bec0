// SPDX-License-Identifier: BSD-3-Clause
// Uncertain clouds in chunks, by a deadline and on several devices have the host's answers of one call, in every bit.
#include "questions/uncertain_forms.hpp"
#include "support/held_stream.cuh"
#include "support/product_device.cuh"

#include <clearance/device.cuh>
#include <clearance/motion_clearance.hpp>
#include <clearance/points/depth_image.hpp>

namespace uncertain_forms_test {

using namespace testing;
using clearance::chunked, clearance::device, clearance::devices, clearance::host, clearance::placed,
    clearance::point_span, clearance::uncertain;

namespace {

/// Radii that all devices read, and the host.
class shared_radii {
 public:
  explicit shared_radii(const std::vector<real>& all) {
    testing::check(cudaMallocManaged(&data_, (all.size() + 1) * sizeof(real)));
    std::copy(all.begin(), all.end(), data_);
  }
  shared_radii(const shared_radii&) = delete;
  shared_radii& operator=(const shared_radii&) = delete;
  ~shared_radii() { cudaFree(data_); }
  const real* data() const { return data_; }

 private:
  real* data_ = nullptr;
};

std::vector<devices> some_devices() {
  std::vector<devices> all = {devices{0, 0}, devices{0, 0, 0}};
  int count = 0;
  testing::check(cudaGetDeviceCount(&count));
  if (count > 1) all.push_back(devices{1, 0});
  return all;
}

}  // namespace

TEST_CASE("On a device uncertain clouds in chunks and by a deadline have the host's answer, wherever points lie") {
  verdict v;
  const device gpu;
  const auto model = arm();
  const auto on_gpu = model.on(gpu);
  const auto pose = shifted(0.1, 0, 0);
  for (const std::size_t n : {0, 1, 4097, 50000})
    for (const real bad : {0.0f, -1.0f}) {
      const wall_of_balls w(n, bad);
      const auto points = gpu.copy_in(std::span<const vec3>(w.points));
      const auto radii = gpu.copy_in(std::span<const real>(w.radii));
      const auto host_points = w.on(w.points.data(), radii.data()), its_points = w.on(points.data(), radii.data());
      for_each_question_of_balls(arm_poses, [&]<class Q>(const char* name, const Q& q, auto poses) {
        const std::string what = std::string(name) + ", " + std::to_string(n) + (bad == 0 ? "" : ", some anywhere");
        clearance::chunked_query ask_it(gpu, on_gpu, q);
        clearance::query query(gpu, on_gpu, q);
        chunked here(host_points, 16384), there(its_points, 1);
        for (int round = 0; round < 3; ++round, poses[0].translation().x() += 0.02) {
          const auto expected = ask(host{}, model, poses, w.source(), pose, q);
          v.require(same_answer(expected, ask_it(poses, here, pose)), what, ", from the host, round ", round);
          v.require(same_answer(expected, ask_it(poses, there, pose)), what, ", on the device, round ", round);
          const placed cloud{its_points, pose};
          if constexpr (clearance::partial_question<Q>)
            v.require(
                same_answer(expected, ask_by(query, poses, cloud, std::chrono::hours(1), q, {.piece = 9999}).result),
                what, ", by a deadline, round ", round);
        }
      });
    }
}

TEST_CASE("On several devices uncertain clouds have the host's answer, cut into slices or in pieces of their own") {
  verdict v;
  const auto model = arm();
  const auto pose = shifted(0.1, 0, 0);
  for (const devices& on : some_devices())
    for (const std::size_t n : {3, 20000}) {
      const wall_of_balls w(n), other(n / 2, -1);
      const shared_radii radii(w.radii), of_other(other.radii);
      const auto there = model.on(on);
      const auto cloud = w.on(w.points.data(), radii.data());
      const auto shards = clearance::shard(on, cloud);
      const auto points = clearance::shard(on, w.points);
      const std::vector<placed<std::remove_const_t<decltype(cloud)>>> two{
          {cloud, pose}, {other.on(other.points.data(), of_other.data()), shifted(0, 0, 9)}};
      for_each_question_of_balls(arm_poses, [&]<class Q>(const char* name, const Q& q, const auto& poses) {
        const std::string what = std::string(name) + ", " + std::to_string(n);
        const auto expected = ask(host{}, model, poses, w.source(), pose, q);
        clearance::query query(on, there, q);
        for (const char* time : {"cold", "warm"})
          v.require(same_answer(expected, typename Q::result(query(poses, placed{cloud, pose}))), what, ", ", time);
        v.require(same_answer(expected, typename Q::result(query(poses, placed{shards.view(), pose}))), what,
                  ", in pieces");
        const uncertain around(points.view(), cloud.noise, {0.002, 0.001, 0.5, 0.02});
        v.require(same_answer(expected, typename Q::result(query(poses, placed{around, pose}))), what,
                  ", around pieces");
        v.require(same_answer(ask(host{}, model, poses, two, q), typename Q::result(query(poses, two))), what,
                  ", two clouds");
      });
      const clearance::certain_distance q{};
      const auto one_alone = [&](const auto& source, const char* what) {
        const auto about = [&](const auto& asked, const auto& at) {
          const auto expected = ask(host{}, model, at, w.source(), pose, asked);
          for (const device& own : on.each())
            v.require(same_answer(expected, ask(own, model.on(own), at, placed{source, pose}, asked)), "device ",
                      own.id, " alone about ", what, ", ", n);
        };
        about(q, arm_poses), about(clearance::in_collision{{0.05}}, arm_poses);
        about(clearance::min_distances{}, std::vector<Eigen::Isometry3d>(arm_poses));
      };
      one_alone(shards.view(), "uncertain pieces");
      one_alone(uncertain(points.view(), cloud.noise, {0.002, 0.001, 0.5, 0.02}), "pieces made uncertain");
      one_alone(
          uncertain(clearance::sharded(std::vector{point_span(w.points)}), cloud.noise, {0.002, 0.001, 0.5, 0.02}),
          "pieces in host memory made uncertain");
      std::vector<Eigen::Isometry3d> to = arm_poses;
      for (auto& at : to) at = shifted(0.2, 0, 0.3) * at;
      const clearance::straight_motion motion(arm_poses, to);
      const auto a = motion_clearance(host{}, model, motion, placed{w.source(), pose}),
                 b = motion_clearance(on, there, motion, placed{cloud, pose});
      v.require(a.state == b.state && same_bits(a.lower, b.lower) && same_bits(a.upper, b.upper) && a.part == b.part &&
                    a.queries == b.queries,
                "a motion");
      std::vector<float> pixels(96 * 64);
      for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i] = i % 97 == 0 ? 0 : real(1 + i % 13) / 5;
      const uncertain image(clearance::depth_image<float>(pixels.data(), 96, 64, {90, 90, 48, 32}), by_number{},
                            {.shift = 0.01, .turn = 0.01});
      v.require(same_answer(ask(host{}, model, arm_poses, image, shifted(0, 0, -2), q),
                            ask(on, there, arm_poses, placed{image, shifted(0, 0, -2)}, q)),
                "an image and a formula of the number");
    }
}

}  // namespace uncertain_forms_test
