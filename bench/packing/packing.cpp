// SPDX-License-Identifier: BSD-3-Clause
// Packs meshes with inner spheres: time, fill, gaps. Mesh files are arguments; without any, the eight links of the KUKA
// LWR 4+ from the data folder. "all" packs one after another, closing the meshes included. --benchmark_format=json.

#include "packing/links.hpp"

#include <cstdio>

namespace {

using namespace packing_bench;

void run(benchmark::State& state, const std::vector<triangle_mesh>& meshes, pack_options options) {
  std::vector<packing> packings;
  for (auto _ : state) {
    packings.clear();
    for (const triangle_mesh& m : meshes) packings.push_back(pack(m, options));
  }
  report(state, packings);
}

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  const auto files = mesh_files(argc, argv);
  if (files.empty()) {
    std::fprintf(stderr, "name mesh files to pack\n");
    return 1;
  }
  std::vector<triangle_mesh> meshes;
  for (const auto& file : files) meshes.push_back(io::load_mesh(file));
  for (std::size_t i = 0; i < files.size(); ++i)
    benchmark::RegisterBenchmark(("pack/" + files[i].stem().string()).c_str(),
                                 [&, i](benchmark::State& state) { run(state, {meshes[i]}, {.count = sphere_count}); })
        ->Unit(benchmark::kMillisecond)
        ->UseRealTime()
        ->Iterations(1);
  const struct {
    const char* name;
    pack_options options;
  } all[] = {{"pack/all", {.count = sphere_count}},
             {"pack/all/strictly_largest_first", {.count = sphere_count, .gap_per_radius = infinity}},
             {"pack/all/overlapping", {.count = sphere_count, .allow_overlap = true}},
             {"pack/all/one_thread", {.count = sphere_count, .threads = 1}}};
  for (const auto& variant : all)
    benchmark::RegisterBenchmark(variant.name,
                                 [&, variant](benchmark::State& state) { run(state, meshes, variant.options); })
        ->Unit(benchmark::kMillisecond)
        ->UseRealTime()
        ->Iterations(1);
  benchmark::RunSpecifiedBenchmarks();
}
