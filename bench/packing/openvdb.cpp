// SPDX-License-Identifier: BSD-3-Clause
// OpenVDB's fillWithSpheres on the links of the KUKA LWR 4+, at the same count, judged by our measures: fill, certified
// gap, and how many of its spheres stick out of the mesh or into one another. --benchmark_format=json.

#include "packing/links.hpp"

#include <openvdb/openvdb.h>
#include <openvdb/tools/MeshToVolume.h>
#include <openvdb/tools/VolumeToSpheres.h>

#include <array>
#include <cstdio>

namespace {

using namespace packing_bench;

/// `finest` voxels along a mesh's longest side, `instances` points to choose from.
packing fill(const mesh_solid& s, int finest, int instances, double& out, double& overlapping) {
  const double voxel = s.bounds().sizes().maxCoeff() / finest;
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec3I> triangles;
  for (const auto& c : s.corners()) points.emplace_back(float(c.x()), float(c.y()), float(c.z()));
  for (const auto& t : s.mesh().surface.triangles) triangles.emplace_back(t[0], t[1], t[2]);
  const auto grid = openvdb::tools::meshToLevelSet<openvdb::FloatGrid>(
      *openvdb::math::Transform::createLinearTransform(voxel), points, triangles);
  std::vector<openvdb::Vec4s> found;
  openvdb::tools::fillWithSpheres(*grid, found, openvdb::Vec2i(int(sphere_count), int(sphere_count)), false, 0.1f,
                                  std::numeric_limits<float>::max(), 0, instances);
  packing p;
  const host here;
  spheres_there<host> before(here);
  for (const auto& f : found) {
    const vec3d c(f[0], f[1], f[2]);
    if (!(f[3] > 0)) continue;
    out += !s.inside(c) || s.distance(c) < f[3];
    overlapping += before.room_in(s.view()).gap(c, f[3]) < f[3] * 0.999;
    p.spheres.push_back({{f[0], f[1], f[2]}, f[3]});
    before.insert(std::array{solid_sphere{c, double(f[3])}});
    before.plant(128);
  }
  const gap_report gap = measure_gap(s, std::span<const inner_sphere>(p.spheres));
  p.gap = gap.certified, p.gap_mean = gap.mean, p.gap_p95 = gap.p95;
  arrange(p, s.volume());
  return p;
}

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  openvdb::initialize();
  const auto files = mesh_files(argc, argv);
  if (files.empty()) {
    std::fprintf(stderr, "name mesh files to pack\n");
    return 1;
  }
  std::vector<mesh_solid> solids;
  for (const auto& file : files) solids.emplace_back(io::load_mesh(file));
  for (const auto& [finest, instances] : {std::pair{100, 10000}, {200, 100000}})
    benchmark::RegisterBenchmark(
        ("openvdb/all/voxels:" + std::to_string(finest) + "/instances:" + std::to_string(instances)).c_str(),
        [&solids, finest = finest, instances = instances](benchmark::State& state) {
          double out = 0, overlapping = 0;
          std::vector<packing> packings;
          for (auto _ : state) {
            packings.clear(), out = overlapping = 0;
            for (const auto& s : solids) packings.push_back(fill(s, finest, instances, out, overlapping));
          }
          report(state, packings);
          state.counters["out"] = out, state.counters["overlapping"] = overlapping;
        })
        ->Unit(benchmark::kMillisecond)
        ->UseRealTime()
        ->Iterations(1);
  benchmark::RunSpecifiedBenchmarks();
}
