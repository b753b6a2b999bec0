// SPDX-License-Identifier: BSD-3-Clause
// Thrust's and CUDA's containers are clouds as they stand: in every form the answers have the bits of a point_span's,
// and answers come into Thrust's vectors.
#include "support/same_answer.hpp"
#include "support/same_result.hpp"

#include <clearance/chunked_query.hpp>
#include <clearance/deadline.hpp>
#include <clearance/device.cuh>
#include <clearance/make_model.hpp>
#include <clearance/questions/distances.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/questions/self_filter.hpp>
#include <clearance/questions/zones.hpp>
#include <clearance/volume/sphere.hpp>

#include <thrust/device_vector.h>
#include <thrust/host_vector.h>
#include <thrust/iterator/zip_iterator.h>
#include <thrust/universal_vector.h>
#include <cuda/std/span>

namespace thrust_test {

using namespace testing;
using clearance::ask, clearance::device, clearance::host, clearance::min_distance, clearance::placed,
    clearance::point_span, clearance::points_in, clearance::points_of;

namespace {

static_assert(std::is_same_v<points_in<thrust::device_vector<float3>>, clearance::in_device_memory<point_span>>);
static_assert(std::is_same_v<points_in<thrust::host_vector<float3>>, point_span>);
static_assert(std::is_same_v<points_in<thrust::universal_vector<float3>>, point_span>);
static_assert(std::is_same_v<points_in<cuda::std::span<const float3>>, point_span>);
template <class C>
concept put = requires(C&& c) { placed{static_cast<C&&>(c)}; };
static_assert(put<thrust::device_vector<float3>&> && !put<thrust::device_vector<float3>>);
static_assert(put<thrust::host_vector<float4>&> && !put<thrust::host_vector<float4>> && put<cuda::std::span<float4>>);

struct given {
  dice d{43};
  std::vector<vec3> points = d.points(20000, 2);
  Eigen::Isometry3d pose = d.pose(0.3);
  std::vector<Eigen::Isometry3d> poses{d.pose(0.5), d.pose(0.5)};
  std::vector<std::vector<inner_sphere>> links{random_spheres(d, 30), random_spheres(d, 30)};
  decltype(clearance::make_model<clearance::sphere>(links)) on_host = clearance::make_model<clearance::sphere>(links);
  device gpu;
  decltype(on_host.on(gpu)) robot = on_host.on(gpu);

  given() {
    for (std::size_t k = 3; k < points.size(); k += 11) (&points[k].x)[k % 3] = clearance::not_a_number;
  }
  thrust::host_vector<float3> float3s() const {
    thrust::host_vector<float3> all;
    for (const vec3& p : points) all.push_back({p.x, p.y, p.z});
    return all;
  }
  thrust::host_vector<float4> float4s() const {
    thrust::host_vector<float4> all;
    for (const vec3& p : points) all.push_back({p.x, p.y, p.z, clearance::not_a_number});
    return all;
  }
  thrust::host_vector<double3> double3s() const {
    thrust::host_vector<double3> all;
    for (const vec3& p : points) all.push_back({p.x, p.y, p.z});
    return all;
  }
  thrust::host_vector<float> column(int k) const {
    thrust::host_vector<float> all;
    for (const vec3& p : points) all.push_back((&p.x)[k]);
    return all;
  }

  /// On a device and, with `here`, the same points in host memory, by a host: the least distance has the same bits.
  template <class Cloud, class Here>
  void check(verdict& v, const Cloud& cloud, const Here& here, const std::string& what) const {
    const auto expected = ask(host{}, on_host, poses, here, min_distance{});
    const auto expected_there = ask(host{}, on_host, poses, here, pose, min_distance{});
    v.require(same_result(ask(gpu, robot, poses, cloud, min_distance{}), expected), what, ": once");
    v.require(same_result(ask(gpu, robot, poses, placed{cloud, pose}, min_distance{}), expected_there), what,
              ": placed");
  }
  template <class Cloud>
  void check(verdict& v, const Cloud& cloud, const std::string& what) const {
    check(v, cloud, point_span(points), what);
  }
};

}  // namespace

TEST_CASE("Every container is asked as it stands, with the bits of a span") {
  const given g;
  verdict v;
  const auto host3 = g.float3s();
  const thrust::device_vector<float3> device3 = host3;
  g.check(v, device3, "device_vector<float3>");
  g.check(v, thrust::device_vector<vec3>(g.points), "device_vector<vec3>");
  g.check(v, points_of(device3.data(), device3.size()), "device_ptr");
  g.check(v, points_of(device3.begin(), device3.size()), "iterator");
  g.check(v, cuda::std::span<const float3>(device3.data().get(), device3.size()), "cuda::std::span");
  g.check(v, thrust::universal_vector<float3>(host3.begin(), host3.end()), "universal_vector");
  g.check(v, thrust::universal_host_pinned_vector<float3>(host3.begin(), host3.end()), "pinned vector");
  g.check(v, host3, "host_vector<float3>");
  const auto host4 = g.float4s();
  g.check(v, thrust::device_vector<float4>(host4), "device_vector<float4>");
  g.check(v, host4, "host_vector<float4>");
  const auto doubles = g.double3s();  // their rounding is in the bracket
  g.check(v, thrust::device_vector<double3>(doubles), doubles, "device_vector<double3>");
  const auto host_x = g.column(0), host_y = g.column(1), host_z = g.column(2);
  const thrust::device_vector<float> x = host_x, y = host_y, z = host_z;
  g.check(v, points_of(thrust::make_zip_iterator(x.begin(), y.begin(), z.begin()), x.size()), "zip");
  g.check(v, points_of(thrust::make_zip_iterator(x.begin() + 1, y.begin() + 1, z.begin() + 1), x.size() - 1),
          point_span(g.points.data() + 1, x.size() - 1), "zip of arrays that are not aligned");
  g.check(v, points_of(thrust::make_zip_iterator(host_x.begin(), host_y.begin(), host_z.begin()), x.size()),
          "zip of host vectors, which are copied");
  g.check(v, points_of(thrust::make_zip_iterator(x.begin(), host_y.begin(), z.begin()), x.size()), "zip of both kinds");
  g.check(v, thrust::device_vector<float3>(), std::vector<vec3>(), "an empty device_vector");
}

TEST_CASE("A host reads host_vector and universal_vector") {
  const given g;
  const auto expected = ask(host{}, g.on_host, g.poses, point_span(g.points), min_distance{});
  const auto of3 = g.float3s();
  const auto of4 = g.float4s();
  CHECK(same_result(ask(host{}, g.on_host, g.poses, of3, min_distance{}), expected));
  CHECK(same_result(ask(host{}, g.on_host, g.poses, of4, min_distance{}), expected));
  const thrust::universal_vector<float3> shared(of3.begin(), of3.end());
  CHECK(same_result(ask(host{}, g.on_host, g.poses, shared, min_distance{}), expected));
}

TEST_CASE("A device_vector is asked in every form, and answers come into device_vectors") {
  const given g;
  verdict v;
  const thrust::device_vector<float3> cloud = g.float3s();
  const point_span plain(g.points);
  const auto expected = ask(host{}, g.on_host, g.poses, plain, min_distance{});
  const auto expected_there = ask(host{}, g.on_host, g.poses, plain, g.pose, min_distance{});

  clearance::query prepared(g.gpu, g.robot, min_distance{});
  for (int frame = 0; frame < 2; ++frame) {
    v.require(same_result(prepared(g.poses, cloud), expected), "prepared");
    v.require(same_result(prepared(g.poses, cloud, g.pose), expected_there), "prepared, placed");
  }
  const std::vector twice{placed{cloud, g.pose}, placed{cloud}};
  v.require(
      same_result(prepared(g.poses, twice),
                  ask(host{}, g.on_host, g.poses, std::vector{placed{plain, g.pose}, placed{plain}}, min_distance{})),
      "several placed ones");
  const std::vector<thrust::device_vector<float3>> both{cloud, cloud};
  v.require(
      same_result(prepared(g.poses, both), ask(host{}, g.on_host, g.poses, std::vector{plain, plain}, min_distance{})),
      "a range of vectors");
  v.require(
      same_result(ask_by(prepared, g.poses, cloud, std::chrono::hours(1), min_distance{}, {5000}).result, expected),
      "by a deadline");
  clearance::chunked chunks(cloud, 5000);
  clearance::chunked_query by_chunks(g.gpu, g.robot, min_distance{});
  v.require(same_result(by_chunks(g.poses, chunks), expected), "in chunks");
  const clearance::devices alone{0};
  const auto there = g.on_host.on(alone);
  v.require(same_result(ask(alone, there, g.poses, cloud, min_distance{}), expected), "several devices");

  thrust::device_vector<clearance::min_distance_result> result(1);
  const auto look = [&](const auto& same, const char* what) {
    const clearance::min_distance_result found = result[0];
    v.require(same_result(found, same), what);
  };
  clearance::enqueue(g.gpu, g.robot, g.poses, cloud, min_distance{}, result.data().get());
  look(expected, "enqueued");
  prepared.enqueue(g.poses, placed{cloud, g.pose}, result.data().get());
  look(expected_there, "enqueued, placed");
  thrust::device_vector<clearance::world_transform> poses;
  for (const auto& pose : g.poses) poses.push_back(clearance::world_transform(pose));
  prepared.enqueue(poses.data().get(), cloud, nullptr, result.data().get());
  look(expected, "enqueued with poses there");

  thrust::device_vector<float> distance(cloud.size());
  thrust::device_vector<clearance::point_counts> counts(1);
  clearance::query every(g.gpu, g.robot, clearance::distances{});
  every.enqueue(g.poses, cloud, {{distance.data().get()}, counts.data().get()});
  const auto all = ask(host{}, g.on_host, g.poses, plain, clearance::distances{});
  const thrust::host_vector<float> copy = distance;
  const clearance::point_counts counted = counts[0];
  v.require(std::ranges::equal(std::span(copy.data(), copy.size()), all.distance, same_bits), "distances");
  v.require(counted.valid == all.counts.valid && counted.seen == cloud.size(), "their counts");

  const clearance::zones zones{.thresholds = {0.1, 0.5}};
  const auto expected_zones = ask(host{}, g.on_host, g.poses, plain, g.pose, zones);
  const auto in_zones = [&](const auto& placed) {
    return same_answer(ask(g.gpu, g.robot, g.poses, placed, zones), expected_zones);
  };
  v.require(in_zones(placed{cloud, g.pose}) && in_zones(std::tuple(placed{cloud, g.pose})), "a question about pairs");

  const clearance::self_filter filter{.padding = {0.05}};
  const auto hidden = ask(host{}, g.on_host, g.poses, plain, filter);
  const thrust::device_vector<clearance::point_label> labels(hidden.labels.begin(), hidden.labels.end());
  v.require(same_result(ask(g.gpu, g.robot, g.poses, masked_clouds(cloud, labels.data().get()), min_distance{}),
                        ask(host{}, g.on_host, g.poses, masked_clouds(plain, hidden.labels.data()), min_distance{})),
            "behind labels");
}

}  // namespace thrust_test
