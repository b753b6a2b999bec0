// SPDX-License-Identifier: BSD-3-Clause
// On a device the bracket is true wherever most points are, and the origin of their floats, and the poses: plain,
// prepared, by parts, for several clouds, and with poses in device memory.
#pragma nv_diag_suppress 20208  // the truth is in long double, on the host
#include "frames/far_scenes.hpp"
#include "support/product_device.cuh"

#include <clearance/device.cuh>
#include <clearance/questions/min_distance.hpp>

namespace far_test {

using namespace testing;
using clearance::device, clearance::host, clearance::placed;

namespace {

struct ask_device {
  verdict& v;

  template <class Body, class Source>
  void operator()(const std::vector<Body>& robot, const std::vector<Eigen::Isometry3d>& poses, const Source& source,
                  const truth& t, const std::string& name) const {
    const auto on_host = model_of(robot);
    const wide distance = t.distance(robot, poses);
    const placed cloud{source, t.pose};
    const auto expected = clearance::ask(host{}, on_host, poses, cloud, clearance::min_distance{});
    const auto by_parts = clearance::ask(host{}, on_host, poses, cloud, clearance::min_distance_per_part{}).all;
    const device gpu;
    const auto model = on_host.on(gpu);
    const auto check = [&](const clearance::min_distance_result& r, const clearance::min_distance_result& as,
                           const char* how) {
      require_bracket(r, distance, v, name + how);
      v.require(same_result(r, as), name, how, ": differs from the host's result");
    };
    // A table of rays is read where it lies: such a source is asked on the host alone.
    if constexpr (!requires { source.rays; }) {
      check(clearance::ask(gpu, model, poses, cloud, clearance::min_distance{}), expected, ", plain");
      check(clearance::ask(gpu, model, poses, cloud, clearance::min_distance_per_part{}).all, by_parts,
            ", plain, by parts");
      clearance::query query(gpu, model, clearance::min_distance{});
      clearance::query per_part(gpu, model, clearance::min_distance_per_part{});
      for (const char* when : {", cold", ", warm"}) {
        check(query(poses, cloud), expected, when);
        check(per_part(poses, cloud).all, by_parts, when);
      }
      const std::vector<placed<Source>> twice = {cloud, {source, t.pose}};
      check(query(poses, twice), clearance::ask(host{}, on_host, poses, twice, clearance::min_distance{}), ", twice");
      const auto bytes = gpu.copy_in(source.bytes());
      std::vector<clearance::world_transform> all(poses.begin(), poses.end());
      all.emplace_back(t.pose);
      const auto there = gpu.copy_in(std::span<const clearance::world_transform>(all));
      auto result = gpu.template make_scratch<clearance::min_distance_result>(1);
      query.enqueue(there.data(), source.at(bytes.data()), there.data() + poses.size(), result.data());
      check(gpu.copy_out(result.data(), 1)[0], expected, ", poses in device memory");
    }
  }
};

}  // namespace

TEST_CASE(
    "On a device the bracket contains the distance however far most points, and the origin of their floats, are") {
  verdict v;
  each_far_question<ball_body>(60, ask_device{v});
  each_far_question<box_body>(60, ask_device{v});
}

TEST_CASE("On a device the bracket contains the distance at poses as far away as poses may be") {
  verdict v;
  each_far_pose<ball_body>(60, ask_device{v});
  each_far_pose<box_body>(60, ask_device{v});
}

}  // namespace far_test
