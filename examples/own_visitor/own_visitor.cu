// SPDX-License-Identifier: BSD-3-Clause
#include "own_visitor.hpp"

#include <clearance/backends/device.cuh>

// [device]
template <clearance::hierarchy Tree>
__global__ void find_three(Tree tree, const clearance::vec3* points, unsigned count,
                           three_nearest::result_type* answers) {
  const unsigned i = blockIdx.x * blockDim.x + threadIdx.x;
  if (i >= count) return;
  three_nearest query;
  clearance::near_first{}(tree, points[i], query);
  answers[i] = query.result();
}

int main() {
  const clearance::device gpu{.id = 0};
  const auto tree = clearance::build<clearance::sphere>(spheres()).on(gpu);
  const auto cloud = points();
  const auto there = gpu.copy_in(std::span<const clearance::vec3>(cloud));
  const auto answers = gpu.make_scratch<three_nearest::result_type>(cloud.size());
  const auto count = unsigned(cloud.size());
  find_three<<<(count + 127) / 128, 128, 0, gpu.stream>>>(tree.view(), there.data(), count, answers.data());
  clearance::check_cuda(cudaGetLastError(), "find_three");
  return check(gpu.copy_out(answers.data(), answers.size()));
}
// [device]
