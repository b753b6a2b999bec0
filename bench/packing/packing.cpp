// SPDX-License-Identifier: BSD-3-Clause
// Packs meshes with inner spheres: time, fill, gaps. Mesh files are arguments; without any, the eight links of the KUKA
// LWR 4+ from the data folder. "all" packs one after another, closing the meshes included. --benchmark_format=json.

#include <clearance/io/mesh.hpp>
#include <clearance/packing/pack.hpp>

#include <benchmark/benchmark.h>

#include <cstdio>

namespace {

using namespace clearance;

constexpr std::size_t sphere_count = 2048;

void report(benchmark::State& state, const std::vector<packing>& packings) {
  double fill = 0, mean = 0, p95 = 0, largest = 0;
  for (const packing& p : packings) {
    fill += p.fill / double(packings.size());
    mean += 1000 * p.gap_mean / double(packings.size());
    p95 += 1000 * p.gap_p95 / double(packings.size());
    largest = std::max(largest, 1000 * p.gap);
  }
  state.counters["fill"] = fill;
  state.counters["gap_mean_mm"] = mean;
  state.counters["gap_p95_mm"] = p95;
  state.counters["gap_mm"] = largest;
  state.counters["spheres"] = double(packings.front().spheres.size());
}

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
  std::vector<std::filesystem::path> files(argv + 1, argv + argc);
  const std::filesystem::path folder = std::filesystem::path(CLEARANCE_TEST_DATA) / "robots/kuka_lwr4plus_cad/meshes";
  if (files.empty() && std::filesystem::exists(folder))
    for (const char* name : {"base", "link_1", "link_2", "link_3", "link_4", "link_5", "link_6", "link_7"})
      files.push_back(folder / (std::string(name) + ".STL"));
  if (files.empty()) {
    std::fprintf(stderr, "name mesh files to pack\n");
    return 1;
  }
  std::vector<triangle_mesh> meshes;
  for (const auto& file : files) meshes.push_back(io::load_mesh(file));
  for (std::size_t i = 0; i < files.size(); ++i)
    benchmark::RegisterBenchmark(("pack/" + files[i].stem().string()).c_str(), [&, i](benchmark::State& state) {
      run(state, {meshes[i]}, {.count = sphere_count});
    })->Unit(benchmark::kMillisecond)->UseRealTime()->Iterations(1);
  const struct {
    const char* name;
    pack_options options;
  } all[] = {{"pack/all", {.count = sphere_count}},
             {"pack/all/strictly_largest_first", {.count = sphere_count, .gap_per_radius = infinity}},
             {"pack/all/overlapping", {.count = sphere_count, .allow_overlap = true}},
             {"pack/all/one_thread", {.count = sphere_count, .threads = 1}}};
  for (const auto& variant : all)
    benchmark::RegisterBenchmark(variant.name, [&, variant](benchmark::State& state) {
      run(state, meshes, variant.options);
    })->Unit(benchmark::kMillisecond)->UseRealTime()->Iterations(1);
  benchmark::RunSpecifiedBenchmarks();
}
