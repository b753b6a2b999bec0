// SPDX-License-Identifier: BSD-3-Clause
#include "own_bvh.hpp"

#include <clearance/device.cuh>

int main() {
  theirs::node* memory = nullptr;  // managed: their pointers mean the same on the CPU and on the GPU
  clearance::check_cuda(cudaMallocManaged(&memory, 600 * sizeof(theirs::node)), "cudaMallocManaged");
  const int failed = example(clearance::device{.id = 0}, {memory, 600});
  clearance::check_cuda(cudaFree(memory), "cudaFree");
  return failed;
}
