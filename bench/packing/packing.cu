// SPDX-License-Identifier: BSD-3-Clause
// Packs meshes with inner spheres on a GPU: time, fill, gaps. Mesh files are arguments; without any, the eight links of
// the KUKA LWR 4+ from the data folder. "all" packs them side by side, each on its stream, including closing the
// meshes; "one_by_one" on one stream; "solids" from solids made beforehand. --benchmark_format=json.

#include "packing/links.hpp"

#include <clearance/packing/pack.cuh>

#include <cstdio>

namespace packing_on_device {
namespace {

using namespace packing_bench;

template <class F>
void measure(const char* name, int times, F f) {
  benchmark::RegisterBenchmark(name,
                               [f](benchmark::State& state) {
                                 std::vector<packing> packings;
                                 for (auto _ : state) packings = f();
                                 report(state, packings);
                               })
      ->Unit(benchmark::kMillisecond)
      ->UseRealTime()
      ->Iterations(times);
}

int run(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  const auto files = mesh_files(argc, argv);
  if (files.empty()) {
    std::fprintf(stderr, "name mesh files to pack\n");
    return 1;
  }
  std::vector<triangle_mesh> meshes;
  std::vector<mesh_solid> solids;
  for (const auto& file : files) meshes.push_back(io::load_mesh(file)), solids.emplace_back(meshes.back());
  pack(device{}, solids.front(), {.count = 10});  // the first call loads the kernels
  const pack_options usual = {.count = sphere_count};
  measure("pack_gpu/all", 5, [&] { return pack(device{}, meshes, usual); });
  measure("pack_gpu/solids", 5, [&] { return pack(device{}, solids, usual); });
  measure("pack_gpu/one_by_one", 3, [&] {
    std::vector<packing> packings;
    for (const auto& m : meshes) packings.push_back(pack(device{}, m, usual));
    return packings;
  });
  measure("pack_gpu/all/strictly_largest_first", 1,
          [&] { return pack(device{}, meshes, {.count = sphere_count, .gap_per_radius = infinity}); });
  measure("pack_gpu/all/overlapping", 1,
          [&] { return pack(device{}, meshes, {.count = sphere_count, .allow_overlap = true}); });
  for (std::size_t i = 0; i < files.size(); ++i)
    for (const std::size_t count : {sphere_count, std::size_t(100000)}) {
      if (count != sphere_count && i != 2 % files.size()) continue;
      const std::string name = "pack_gpu/" + files[i].stem().string() + "/spheres:" + std::to_string(count);
      measure(name.c_str(), 1,
              [&, i, count] { return std::vector<packing>{pack(device{}, meshes[i], {.count = count})}; });
    }
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}

}  // namespace
}  // namespace packing_on_device

int main(int count, char** arguments) { return packing_on_device::run(count, arguments); }
