// SPDX-License-Identifier: BSD-3-Clause
// Foreign data on a GPU, compared with ours: a binary tree linked by pointers, and points in records of 32 bytes. Robot
// and frame are those of min_distance.cu; times are the device's alone, behind other work.
#include "../../tests/support/linked_tree.hpp"
#include "device.cuh"
#include "scene_files.hpp"

#include <clearance/points/strided_points.hpp>
#include <clearance/volume/sphere.hpp>

namespace foreign_bench {
namespace {

using namespace bench;
using clearance::device, clearance::inner_sphere, clearance::sphere;

const auto& ours() {
  static const auto model = sphere_model<sphere>(the_scene());
  return model;
}

template <class Robot, class Source>
void ask(benchmark::State& state, const Robot& robot, const Source& source, bool cold) {
  const device gpu;
  clearance::query query(gpu, robot, clearance::min_distance{});
  const clearance::device_buffer<clearance::min_distance_result> result(1, gpu.id);
  const device_clock clock(true);
  const clearance::placed cloud{source, the_scene().world_from_camera};
  const auto frame = [&] { query.enqueue(the_scene().poses, cloud, result.data()); };
  frame();
  for (auto _ : state) {
    if (cold) query.forget();
    state.SetIterationTime(clock.seconds(frame));
  }
  state.counters["distance_mm"] = gpu.copy_out(result)[0].distance * 1e3;
}

void ours_float3(benchmark::State& state, bool cold) {
  if (no_device(state)) return;
  const device gpu;
  const auto there = gpu.copy_in(std::span<const clearance::vec3>(the_scene().cloud));
  ask(state, ours().on(gpu), clearance::point_span(there.data(), there.size()), cold);
}

void linked_tree(benchmark::State& state, bool cold) {
  if (no_device(state)) return;
  using view = clearance::part_view<testing::linked_view<sphere, inner_sphere>>;
  const device gpu;
  const auto points = gpu.copy_in(std::span<const clearance::vec3>(the_scene().cloud));
  std::vector<device::buffer<testing::linked_node<sphere, inner_sphere>>> nodes;
  std::vector<view> parts;
  std::vector<clearance::part_facts> facts;
  std::uint32_t depth = 0;
  for (const auto& part : ours().parts()) {  // in the order of our leaves, so that neighbours stay close
    const testing::linked_tree<sphere, inner_sphere> tree(part.tree.primitives);
    nodes.push_back(gpu.copy_in(std::span<const testing::linked_node<sphere, inner_sphere>>(tree.placed_at(nullptr))));
    const auto moved = tree.placed_at(nodes.back().data());
    gpu.stage(std::span<const testing::linked_node<sphere, inner_sphere>>(moved), nodes.back().data());
    depth = std::max(depth, tree.view().depth());
    facts.push_back(part.facts);
    parts.push_back({{nodes.back().data(), tree.view().depth()}, {}, part.facts});
  }
  const auto there = gpu.copy_in(std::span<const view>(parts));
  ask(state, clearance::model_view<view>{there.data(), facts, depth, 2},
      clearance::point_span(points.data(), points.size()), cold);
}

void records(benchmark::State& state, bool cold) {
  if (no_device(state)) return;
  const device gpu;
  std::vector<float> wide;
  for (const auto& p : the_scene().cloud) wide.insert(wide.end(), {p.x, p.y, p.z, 0, 0, 0, 0, 0});
  const auto there = gpu.copy_in(std::span<const float>(wide));
  ask(state, ours().on(gpu),
      clearance::strided_points<>{
          .data = reinterpret_cast<const std::byte*>(there.data()), .count = wide.size() / 8, .step = 32},
      cold);
}

#define TIMED ->UseManualTime()->Unit(benchmark::kMicrosecond)->Iterations(200)->Repetitions(3)->ReportAggregatesOnly()
BENCHMARK_CAPTURE(ours_float3, warm, false) TIMED;
BENCHMARK_CAPTURE(ours_float3, cold, true) TIMED;
BENCHMARK_CAPTURE(linked_tree, warm, false) TIMED;
BENCHMARK_CAPTURE(linked_tree, cold, true) TIMED;
BENCHMARK_CAPTURE(records, of_32_bytes_warm, false) TIMED;
BENCHMARK_CAPTURE(records, of_32_bytes_cold, true) TIMED;

}  // namespace
}  // namespace foreign_bench

int main(int argc, char** argv) { return bench::run_all(argc, argv); }
