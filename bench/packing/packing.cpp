// SPDX-License-Identifier: BSD-3-Clause
// Packs meshes with inner spheres: time, fill, gaps. Mesh files are arguments; without any, the eight links of the KUKA
// LWR 4+ from the data folder. "all" packs them side by side, as for a robot's links, "one_by_one" one after another;
// both include closing the meshes. --benchmark_format=json.

#include "packing/links.hpp"

#include <cstdio>

namespace {

using namespace packing_bench;

std::vector<packing> together(const std::vector<triangle_mesh>& meshes, const pack_options& options) {
  return pack(meshes, options);
}

std::vector<packing> one_by_one(const std::vector<triangle_mesh>& meshes, const pack_options& options) {
  std::vector<packing> packings;
  for (const triangle_mesh& m : meshes) packings.push_back(pack(m, options));
  return packings;
}

template <class Pack>
void measure(const std::string& name, Pack pack) {
  benchmark::RegisterBenchmark(name.c_str(),
                               [pack](benchmark::State& state) {
                                 std::vector<packing> packings;
                                 for (auto _ : state) packings = pack();
                                 report(state, packings);
                               })
      ->Unit(benchmark::kMillisecond)
      ->UseRealTime()
      ->MeasureProcessCPUTime()
      ->Iterations(1);
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
  const pack_options usual = {.count = sphere_count};
  for (std::size_t i = 0; i < files.size(); ++i)
    measure("pack/" + files[i].stem().string(), [&, i] { return std::vector{pack(meshes[i], usual)}; });
  const struct {
    const char* name;
    std::vector<packing> (*pack)(const std::vector<triangle_mesh>&, const pack_options&);
    pack_options options;
  } all[] = {{"pack/all", together, usual},
             {"pack/one_by_one", one_by_one, usual},
             {"pack/all/strictly_largest_first", together, {.count = sphere_count, .gap_per_radius = infinity}},
             {"pack/all/overlapping", together, {.count = sphere_count, .allow_overlap = true}},
             {"pack/all/one_thread", together, {.count = sphere_count, .threads = 1}},
             {"pack/all/seed:1", together, {.count = sphere_count, .seed = 1}},
             {"pack/all/seed:2", together, {.count = sphere_count, .seed = 2}},
             {"pack/all/seed:3", together, {.count = sphere_count, .seed = 3}},
             {"pack/all/four_times_as_many", together, {.count = 4 * sphere_count}}};
  for (const auto& variant : all) measure(variant.name, [&] { return variant.pack(meshes, variant.options); });
  benchmark::RunSpecifiedBenchmarks();
}
