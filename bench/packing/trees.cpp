// SPDX-License-Identifier: BSD-3-Clause
// Trees over the packings of the KUKA LWR 4+ (2,048 spheres per link). For the distance of a point to all links in
// turn: bounds and primitives tested, by split rule, width and fit; and how far the spheres' minimum is from the
// triangles', 5 cm, 20 cm and 1 m from the robot. --benchmark_format=json.

#include "packing/links.hpp"

#include <clearance/bvh/build.hpp>
#include <clearance/io/robot.hpp>
#include <clearance/traversal/near_first.hpp>
#include <clearance/visitor/nearest.hpp>
#include <clearance/volume/sphere.hpp>

#include <cstdio>
#include <random>

namespace {

using namespace packing_bench;

std::size_t bounds_tested = 0, primitives_tested = 0;

struct counted_sphere {
  sphere s;
  static counted_sphere fit(std::span<const ball> balls) { return {sphere::fit(balls)}; }
  CLEARANCE_HD real lower_bound(vec3 p) const { return ++bounds_tested, s.lower_bound(p); }
  auto balls() const { return s.balls(); }
};
struct counted_inner {
  inner_sphere s;
  CLEARANCE_HD real distance(vec3 p) const { return ++primitives_tested, s.distance(p); }
  CLEARANCE_HD vec3 nearest(vec3 p) const { return s.nearest(p); }
  CLEARANCE_HD vec3 normal(vec3 p) const { return s.normal(p); }
  auto balls() const { return s.balls(); }
};

struct posed_link {
  mesh_solid solid;
  std::vector<counted_inner> spheres;
  Eigen::Isometry3d part_from_world;
};
struct robot_and_points {
  std::vector<posed_link> links;
  double away[3] = {0.05, 0.2, 1};
  std::vector<Eigen::Vector3d> points[3];
  std::vector<double> exact[3];

  double to_solids(const Eigen::Vector3d& p) const {
    double best = std::numeric_limits<double>::infinity();
    for (const posed_link& l : links) {
      const Eigen::Vector3d q = l.part_from_world * p;
      if (l.solid.inside(q)) return 0;
      best = l.solid.distance(q, best);
    }
    return best;
  }
};

robot_and_points load() {
  robot_and_points r;
  const auto arm =
      io::load_robot(std::filesystem::path(CLEARANCE_TEST_DATA) / "robots/kuka_lwr4plus_cad/kuka_lwr4plus.urdf");
  const std::vector<double> bent = {0.3, 0.7, -0.2, -1.2, 0.4, 0.9, 0};
  const auto poses = arm.poses(bent);
  Eigen::AlignedBox3d bounds;
  for (std::size_t i = 0; i < arm.parts().size(); ++i) {
    mesh_solid solid(arm.parts()[i].mesh);
    std::vector<counted_inner> spheres;
    for (const inner_sphere& s : pack(solid, {.count = sphere_count}).spheres) spheres.push_back({s});
    for (const auto& c : solid.corners()) bounds.extend(Eigen::Vector3d(poses[i] * c));
    r.links.push_back({std::move(solid), std::move(spheres), poses[i].inverse()});
  }
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  const double far = 2 * bounds.diagonal().norm() + 2;
  for (int k = 0; k < 3; ++k)
    while (r.points[k].size() < 3000) {  // from far away towards the robot, up to this distance
      Eigen::Vector3d at(normal(random), normal(random), normal(random));
      at = bounds.center() + far * at.normalized();
      const Eigen::Vector3d target =
          bounds.center() +
          Eigen::Vector3d(normal(random), normal(random), normal(random)).cwiseProduct(bounds.sizes()) / 4;
      const Eigen::Vector3d way = (target - at).normalized();
      double d = r.to_solids(at);
      for (double gone = 0; d > r.away[k] + 1e-9 && gone < 2 * far; d = r.to_solids(at))
        at += (d - r.away[k]) * way, gone += d - r.away[k];
      if (d > r.away[k] + 1e-6) continue;
      const Eigen::Vector3d rounded = at.cast<float>().cast<double>();
      r.points[k].push_back(rounded), r.exact[k].push_back(r.to_solids(rounded));
    }
  return r;
}

template <class Fit, class Split>
void tests(benchmark::State& state, const robot_and_points& r, std::uint32_t width, Fit fit, Split split) {
  std::vector<bvh<counted_sphere, counted_inner>> trees;
  for (const auto& l : r.links) trees.push_back(build<counted_sphere>(l.spheres, {.width = width}, fit, split));
  double sum = 0, error[3] = {}, worst[3] = {};
  for (auto _ : state) {
    bounds_tested = primitives_tested = 0;
    for (int k = 0; k < 3; ++k) {
      error[k] = worst[k] = 0;
      for (std::size_t i = 0; i < r.points[k].size(); ++i) {
        nearest best;
        real d = infinity;
        for (std::size_t l = 0; l < trees.size(); ++l) {
          const Eigen::Vector3f q = (r.links[l].part_from_world * r.points[k][i]).cast<float>();
          nearest ask{d};
          near_first{}(trees[l].view(), vec3{q.x(), q.y(), q.z()}, ask);
          d = std::min(d, ask.reach());
        }
        sum += d;
        const double e = d - r.exact[k][i];
        error[k] += 1000 * e / double(r.points[k].size()), worst[k] = std::max(worst[k], 1000 * e);
      }
    }
  }
  const double points = double(r.points[0].size() + r.points[1].size() + r.points[2].size());
  state.counters["bounds"] = double(bounds_tested) / points;
  state.counters["spheres"] = double(primitives_tested) / points;
  state.counters["us_a_point"] =
      benchmark::Counter(points * 1e-6, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  for (int k = 0; k < 3; ++k) {
    const std::string at = std::to_string(int(100 * r.away[k])) + "cm";
    state.counters["error_mm_" + at] = error[k];
    state.counters["worst_mm_" + at] = worst[k];
  }
  benchmark::DoNotOptimize(sum);
}

template <class Fit, class Split>
void add(const robot_and_points& r, const char* fit_name, Fit fit, const char* split_name, Split split) {
  for (const std::uint32_t width : {2, 4, 8})
    benchmark::RegisterBenchmark(
        (std::string("tree/") + split_name + "/" + fit_name + "/width:" + std::to_string(width)).c_str(),
        [&r, fit, split, width](benchmark::State& state) { tests(state, r, width, fit, split); })
        ->Unit(benchmark::kMillisecond);
}

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (!std::filesystem::exists(std::filesystem::path(CLEARANCE_TEST_DATA) / "robots/kuka_lwr4plus_cad")) {
    std::fprintf(stderr, "there is no robot in %s\n", CLEARANCE_TEST_DATA);
    return 1;
  }
  const robot_and_points r = load();
  add(r, "wrapped", wrapped{}, "surface_area", surface_area_split{});
  add(r, "wrapped", wrapped{}, "median", median_split{});
  add(r, "wrapped", wrapped{}, "principal", principal_split{});
  add(r, "wrapped", wrapped{}, "two_means", two_means_split{});
  add(r, "wrapped", wrapped{}, "neural_gas", neural_gas_split{});
  add(r, "layered", layered{}, "surface_area", surface_area_split{});
  benchmark::RegisterBenchmark("tree/memory/spheres:14000/width:8", [&r](benchmark::State& state) {
    std::vector<inner_sphere> spheres;
    for (const auto& l : r.links)
      for (const auto& s : l.spheres)
        if (spheres.size() < 14000)
          spheres.push_back(
              {{s.s.center.x + real(spheres.size() / sphere_count), s.s.center.y, s.s.center.z}, s.s.radius});
    for (auto _ : state) {
      const auto tree = build<sphere>(spheres);
      state.counters["kB"] =
          double(tree.volumes.size() * sizeof(sphere) + tree.nodes.size() * sizeof(bvh_node) +
                 tree.primitives.size() * sizeof(inner_sphere) + tree.ids.size() * sizeof(std::uint32_t)) /
          1000;
    }
  })->Unit(benchmark::kMillisecond);
  benchmark::RunSpecifiedBenchmarks();
}
