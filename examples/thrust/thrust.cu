// SPDX-License-Identifier: BSD-3-Clause
// A cloud in Thrust's containers, and answers in them.
#include <clearance/device.cuh>
#include <clearance/make_model.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/questions/distances.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/volume/sphere.hpp>

#include <thrust/count.h>
#include <thrust/device_vector.h>
#include <thrust/host_vector.h>
#include <thrust/iterator/zip_iterator.h>
#include <thrust/tabulate.h>
#include <cstdio>

namespace {

/// Point i of a wall, 100 points wide.
struct wall {
  __host__ __device__ float3 operator()(int i) const {
    return {0.02f * float(i % 100) - 1, 0.3f + 0.001f * float(i % 7), 0.02f * float(i / 100) - 1};
  }
};
struct closer_than {
  float limit;
  __host__ __device__ bool operator()(float distance) const { return distance < limit; }
};

}  // namespace

int main() {
  std::vector<std::vector<clearance::inner_sphere>> links(2);
  for (int k = 0; k < 2; ++k)
    for (int i = 0; i < 40; ++i) links[std::size_t(k)].push_back({{0.02f * float(i), 0.1f * float(k), 0}, 0.04f});
  const std::vector<Eigen::Isometry3d> poses(2, Eigen::Isometry3d::Identity());
  const clearance::device gpu;
  const auto robot = clearance::make_model<clearance::sphere>(links).on(gpu);

  // [cloud]
  thrust::device_vector<float3> cloud(10000);
  thrust::tabulate(cloud.begin(), cloud.end(), wall{});
  const auto r = clearance::ask(gpu, robot, poses, cloud, clearance::min_distance{});  // read where it lies
  // [cloud]

  // [zip]
  const thrust::device_vector<float> x(100, 0.1f), y(100, 0.5f), z(100, -0.2f);
  const auto zip = thrust::make_zip_iterator(x.begin(), y.begin(), z.begin());
  const auto of_arrays =
      clearance::ask(gpu, robot, poses, clearance::points_of(zip, x.size()), clearance::min_distance{});
  // [zip]

  // [answers]
  thrust::device_vector<float> distance(cloud.size());
  thrust::device_vector<clearance::point_counts> counts(1);
  clearance::query every(gpu, robot, clearance::distances{});
  every.enqueue(poses, cloud, {{distance.data().get()}, counts.data().get()});  // it does not wait
  const auto near = thrust::count_if(distance.begin(), distance.end(), closer_than{0.25f});
  // [answers]

  std::printf("%.6f m to point %u; %td of %zu points are nearer than 25 cm\n", r.distance, r.point, near, cloud.size());
  // The same on the host, from a copy.
  const auto on_host = clearance::make_model<clearance::sphere>(links);
  const thrust::host_vector<float3> copy = cloud;
  const auto same = clearance::ask(clearance::host{}, on_host, poses, copy, clearance::min_distance{});
  const auto all = clearance::ask(clearance::host{}, on_host, poses, copy, clearance::distances{});
  const clearance::point_counts counted = counts[0];
  return r.distance == same.distance && r.point == same.point && of_arrays.seen == 100 && of_arrays.point == 0 &&
                 near > 0 && near == std::count_if(all.distance.begin(), all.distance.end(), closer_than{0.25f}) &&
                 thrust::host_vector<float>(distance) == all.distance && counted.valid == cloud.size()
             ? 0
             : 1;
}
