// SPDX-License-Identifier: BSD-3-Clause
// One frame on the CPU: 307,200 points against the whole robot, by model and volume; and FCL on the same work.
#include "scene.hpp"

#include <clearance/min_distance.hpp>
#include <clearance/volume/aabb.hpp>
#include <clearance/volume/obb.hpp>
#include <clearance/volume/sphere.hpp>

#include <benchmark/benchmark.h>

#if __has_include(<fcl/geometry/bvh/BVH_model.h>)
#define CLEARANCE_BENCH_FCL
#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/broadphase/default_broadphase_callbacks.h>
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/sphere.h>
#endif

namespace {

template <class Model>
void ask(benchmark::State& state, const Model& model) {
  const bench::scene& s = bench::the_scene();
  const clearance::host cpu{.threads = unsigned(state.range(0))};
  const clearance::placed<clearance::point_span> cloud{s.cloud, s.world_from_camera};
  clearance::min_distance_result r;
  for (auto _ : state) r = clearance::min_distance(cpu, model, s.poses, cloud);
  state.counters["distance_mm"] = r.distance * 1e3;
  state.counters["points"] = double(s.cloud.size());
}

template <class V>
void spheres(benchmark::State& state) {
  static const auto model = bench::sphere_model<V>(bench::the_scene());
  ask(state, model);
}
template <class V>
void triangles(benchmark::State& state) {
  static const auto model = bench::triangle_model<V>(bench::the_scene());
  ask(state, model);
}

#define ON_THREADS ->Arg(1)->Arg(2)->ArgName("threads")->UseRealTime()->Unit(benchmark::kMillisecond)
BENCHMARK(spheres<clearance::sphere>) ON_THREADS;
BENCHMARK(spheres<clearance::aabb>) ON_THREADS;
BENCHMARK(spheres<clearance::obb>) ON_THREADS;
BENCHMARK(triangles<clearance::sphere>) ON_THREADS;
BENCHMARK(triangles<clearance::aabb>) ON_THREADS;
BENCHMARK(triangles<clearance::obb>) ON_THREADS;

#ifdef CLEARANCE_BENCH_FCL
/// Mesh trees against a dynamic tree of radius-0 spheres: FCL's exact way to ask for a cloud. The tree is made per frame.
void fcl_meshes(benchmark::State& state) {
  const bench::scene& s = bench::the_scene();
  using tree = fcl::BVHModel<fcl::OBBRSSd>;
  std::vector<std::unique_ptr<fcl::CollisionObjectd>> links;
  fcl::DynamicAABBTreeCollisionManagerd robot;
  for (std::size_t k = 0; k < s.meshes.size(); ++k) {
    const auto body = std::make_shared<tree>();
    body->beginModel();
    const auto& [vertices, faces] = s.meshes[k].surface;
    for (const auto& f : faces)
      if ((vertices[f[1]] - vertices[f[0]]).cross(vertices[f[2]] - vertices[f[0]]).norm() > 0)
        body->addTriangle(vertices[f[0]], vertices[f[1]], vertices[f[2]]);
    body->endModel();
    links.push_back(std::make_unique<fcl::CollisionObjectd>(body, s.world_from_camera.inverse() * s.poses[k]));
    robot.registerObject(links.back().get());
  }
  robot.setup();
  double distance = 0, query = 0;
  for (auto _ : state) {
    std::vector<std::unique_ptr<fcl::CollisionObjectd>> points;
    std::vector<fcl::CollisionObjectd*> pointers;
    const auto dot = std::make_shared<fcl::Sphered>(0.0);
    for (const auto& p : s.cloud) {
      if (!clearance::is_finite(p)) continue;
      points.push_back(std::make_unique<fcl::CollisionObjectd>(dot, Eigen::Matrix3d::Identity(), Eigen::Vector3d(p.x, p.y, p.z)));
      pointers.push_back(points.back().get());
    }
    fcl::DynamicAABBTreeCollisionManagerd cloud;
    cloud.registerObjects(pointers);
    cloud.setup();
    fcl::DefaultDistanceData<double> data;
    const auto start = std::chrono::steady_clock::now();
    robot.distance(&cloud, &data, fcl::DefaultDistanceFunction);
    query += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    distance = data.result.min_distance;
  }
  state.counters["distance_mm"] = distance * 1e3;
  state.counters["query_ms"] = benchmark::Counter(query * 1e3, benchmark::Counter::kAvgIterations);
}
BENCHMARK(fcl_meshes)->Iterations(1)->Unit(benchmark::kMillisecond);
#endif

}  // namespace

BENCHMARK_MAIN();
