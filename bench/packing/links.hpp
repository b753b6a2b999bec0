// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/io/mesh.hpp>
#include <clearance/packing/pack.hpp>

#include <benchmark/benchmark.h>

#include <filesystem>

namespace packing_bench {

using namespace clearance;

constexpr std::size_t sphere_count = 2048;

/// The eight links of the KUKA LWR 4+ from the data folder, or the given mesh files.
inline std::vector<std::filesystem::path> mesh_files(int argc, char** argv) {
  std::vector<std::filesystem::path> files(argv + 1, argv + argc);
  const std::filesystem::path folder = std::filesystem::path(CLEARANCE_TEST_DATA) / "robots/kuka_lwr4plus_cad/meshes";
  if (files.empty() && std::filesystem::exists(folder))
    for (const char* name : {"base", "link_1", "link_2", "link_3", "link_4", "link_5", "link_6", "link_7"})
      files.push_back(folder / (std::string(name) + ".STL"));
  return files;
}

inline void report(benchmark::State& state, const std::vector<packing>& packings) {
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

}  // namespace packing_bench
