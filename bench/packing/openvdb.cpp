// SPDX-License-Identifier: BSD-3-Clause
// OpenVDB's fillWithSpheres on the links of the KUKA LWR 4+, compared with pack: the same count, one thread, one judge
// of fill, certified gap, and how many spheres stick out of the mesh or into one another. CPU seconds without the judge
// (make_s; pack's include its own certificate), and of a certificate (certify_s). --benchmark_format=json.

#include "packing/links.hpp"

#include <openvdb/openvdb.h>
#include <openvdb/tools/MeshToVolume.h>
#include <openvdb/tools/VolumeToSpheres.h>
#include <tbb/global_control.h>

#include <array>
#include <cstdio>
#include <ctime>

namespace {

using namespace packing_bench;

using balls = std::vector<inner_sphere>;

/// `finest` voxels along a mesh's longest side, `instances` points to choose from.
balls fill(const mesh_solid& s, int finest, int instances) {
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
  balls made;
  for (const auto& f : found)
    if (f[3] > 0) made.push_back({{f[0], f[1], f[2]}, f[3]});
  return made;
}

struct tally {
  double out = 0, overlapping = 0, spheres = 0, make_s = 0, certify_s = 0;
};

double cpu_seconds() { return double(std::clock()) / CLOCKS_PER_SEC; }

template <class Make>
packing judged(const mesh_solid& s, Make make, tally& all) {
  packing p;
  const double begun = cpu_seconds();
  p.spheres = make(s);
  all.make_s += cpu_seconds() - begun, all.spheres += double(p.spheres.size());
  const host here;
  spheres_there<host> before(here);
  for (const inner_sphere& b : p.spheres) {
    const vec3d c(b.center.x, b.center.y, b.center.z);
    all.out += !s.inside(c) || s.distance(c) < b.radius;
    all.overlapping += before.room_in(s.view()).gap(c, b.radius) < b.radius * 0.999;
    before.insert(std::array{solid_sphere{c, double(b.radius)}});
    before.plant(128);
  }
  const double made = cpu_seconds();
  const gap_report gap = measure_gap(s, std::span<const inner_sphere>(p.spheres));
  all.certify_s += cpu_seconds() - made;
  p.gap = gap.certified, p.gap_mean = gap.mean, p.gap_p95 = gap.p95;
  arrange(p, s.volume());
  return p;
}

template <class Make>
void measure(const std::string& name, const std::vector<mesh_solid>& solids, Make make) {
  benchmark::RegisterBenchmark(name.c_str(),
                               [&solids, make](benchmark::State& state) {
                                 tally all;
                                 std::vector<packing> packings;
                                 for (auto _ : state) {
                                   packings.clear(), all = {};
                                   for (const auto& s : solids) packings.push_back(judged(s, make, all));
                                 }
                                 report(state, packings);
                                 state.counters["spheres"] = all.spheres;
                                 state.counters["out"] = all.out, state.counters["overlapping"] = all.overlapping;
                                 state.counters["make_s"] = all.make_s, state.counters["certify_s"] = all.certify_s;
                               })
      ->Unit(benchmark::kMillisecond)
      ->MeasureProcessCPUTime()
      ->Iterations(1);
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
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  measure("pack/all", solids,
          [](const mesh_solid& s) { return pack(s, {.count = sphere_count, .threads = 1}).spheres; });
  for (const auto& [finest, instances] : {std::pair{100, 10000}, {200, 100000}})
    measure("openvdb/all/voxels:" + std::to_string(finest) + "/instances:" + std::to_string(instances), solids,
            [finest = finest, instances = instances](const mesh_solid& s) { return fill(s, finest, instances); });
  benchmark::RunSpecifiedBenchmarks();
}
