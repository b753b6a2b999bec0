// SPDX-License-Identifier: BSD-3-Clause
// FCL on the same frame. Exact: trees of the links' meshes and a dynamic tree of spheres of radius 0, FCL's way to
// query a cloud; that tree is made for each frame. Approximate: the links and an octree of the cloud.
#include "peers/ours.hpp"

#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/broadphase/default_broadphase_callbacks.h>
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/octree/octree.h>
#include <fcl/geometry/shape/sphere.h>

namespace {

using manager = fcl::DynamicAABBTreeCollisionManagerd;

class links {
 public:
  links() {
    const bench::scene& s = peers::scene();
    for (std::size_t k = 0; k < s.meshes.size(); ++k) {
      const auto body = std::make_shared<fcl::BVHModel<fcl::OBBRSSd>>();
      body->beginModel();
      const auto& vertices = s.meshes[k].surface.vertices;
      const auto& faces = s.meshes[k].surface.triangles;
      for (const auto& f : faces)
        if ((vertices[f[1]] - vertices[f[0]]).cross(vertices[f[2]] - vertices[f[0]]).norm() > 0)
          body->addTriangle(vertices[f[0]], vertices[f[1]], vertices[f[2]]);
      body->endModel();
      objects_.push_back(std::make_unique<fcl::CollisionObjectd>(body, s.world_from_camera.inverse() * s.poses[k]));
      robot.registerObject(objects_.back().get());
    }
    robot.setup();
  }
  manager robot;

 private:
  std::vector<std::unique_ptr<fcl::CollisionObjectd>> objects_;
};

class stopwatch {
 public:
  double lap() {
    const auto now = std::chrono::steady_clock::now();
    return std::chrono::duration<double, std::milli>(now - std::exchange(last_, now)).count();
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

/// The least distance from the robot to a manager or an object; adds the time to `query`.
template <class Cloud>
double least(links& all, Cloud* cloud, double& query) {
  fcl::DefaultDistanceData<double> data;
  stopwatch watch;
  all.robot.distance(cloud, &data, fcl::DefaultDistanceFunction);
  query += watch.lap();
  return data.result.min_distance;
}

void say(benchmark::State& state, double distance, double query) {
  state.counters["distance_mm"] = distance * 1e3;
  state.counters["query_ms"] = benchmark::Counter(query, benchmark::Counter::kAvgIterations);
}

void fcl_exact(benchmark::State& state) {
  links all;
  double distance = 0, query = 0;
  for (auto _ : state) {
    std::vector<std::unique_ptr<fcl::CollisionObjectd>> points;
    std::vector<fcl::CollisionObjectd*> pointers;
    const auto dot = std::make_shared<fcl::Sphered>(0.0);
    for (const auto& p : peers::scene().cloud) {
      if (!clearance::is_finite(p)) continue;
      points.push_back(
          std::make_unique<fcl::CollisionObjectd>(dot, Eigen::Matrix3d::Identity(), Eigen::Vector3d(p.x, p.y, p.z)));
      pointers.push_back(points.back().get());
    }
    manager cloud;
    cloud.registerObjects(pointers);
    cloud.setup();
    distance = least(all, &cloud, query);
  }
  say(state, distance, query);
}

/// Cells of 1 cm: too short by up to half a cell's diagonal.
void fcl_octree(benchmark::State& state) {
  links all;
  double distance = 0, query = 0;
  for (auto _ : state) {
    const auto cells = std::make_shared<octomap::OcTree>(0.01);
    for (const auto& p : peers::scene().cloud)
      if (clearance::is_finite(p)) cells->updateNode(octomap::point3d(p.x, p.y, p.z), true, true);
    cells->updateInnerOccupancy();
    fcl::CollisionObjectd cloud(std::make_shared<fcl::OcTreed>(cells));
    distance = least(all, &cloud, query);
  }
  say(state, distance, query);
}

BENCHMARK(peers::ours_cold)->Unit(benchmark::kMillisecond);
BENCHMARK(peers::ours_warm)->Unit(benchmark::kMillisecond);
BENCHMARK(fcl_exact)->Iterations(5)->Unit(benchmark::kMillisecond);
BENCHMARK(fcl_octree)->Iterations(3)->Unit(benchmark::kMillisecond);
BENCHMARK(peers::ours_cold)->Name("ours_cold again")->Unit(benchmark::kMillisecond);

}  // namespace

int main(int argc, char** argv) { return bench::run_all(argc, argv); }
