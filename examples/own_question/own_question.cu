// SPDX-License-Identifier: BSD-3-Clause
#include "own_question.hpp"

#include <clearance/device.cuh>

int main() {
  using namespace own_question;
  const clearance::device gpu{.stream = cudaStreamPerThread};
  const auto robot = clearance::make_model<clearance::sphere>(links());
  const auto there = robot.on(gpu);
  const auto points = gpu.copy_in(std::span<const clearance::vec3>(cloud()));
  const clearance::point_span on_gpu(std::span<const clearance::vec3>(points.data(), points.size()));
  // [graph]
  clearance::query prepared(gpu, there, nearness{});
  int failures = wrong("prepared", prepared(poses(), cloud()));

  clearance::device_buffer<unsigned long long> near(9, gpu.id);
  clearance::device_buffer<clearance::point_counts> counts(1, gpu.id);
  const nearness::out to{near.data(), counts.data()};
  cudaGraph_t graph;
  cudaGraphExec_t launch;
  cudaStreamBeginCapture(gpu.stream, cudaStreamCaptureModeThreadLocal);
  prepared.enqueue(poses(), on_gpu, to);
  cudaStreamEndCapture(gpu.stream, &graph);
  cudaGraphInstantiate(&launch, graph, 0);
  for (int frame = 0; frame < 3; ++frame) cudaGraphLaunch(launch, gpu.stream);
  failures += wrong("graph", {gpu.copy_out(near), gpu.copy_out(counts)[0]});

  const clearance::devices two{0, 0};  // one GPU may be named twice, so that a program can be tried anywhere
  failures += wrong("two GPUs", clearance::ask(two, robot.on(two), poses(), cloud(), nearness{}));
  // [graph]
  cudaGraphExecDestroy(launch), cudaGraphDestroy(graph);
  return failures;
}
