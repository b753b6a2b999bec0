// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// All CPU methods by the size of the cloud (the paper's Fig. 9): Algorithm 1 as compiled and with SIMD by hand, the
// octree with and without its construction, and ours.

#include "octree.hpp"
#include "report.hpp"
#include "scenes.hpp"
#include "sequential.hpp"
#include "simd.hpp"

#include <clearance/questions/min_distance.hpp>
#include <clearance/traversal/recursive.hpp>

#include <thread>

namespace bench::paper {

/// Seconds to measure one competitor.
inline double host_budget = 0.15;

template <class Model>
void host_competitors(report& out, const scenario& scene, std::size_t count, const Model& model, const Model& binary) {
  const auto points = scene.points(count);
  const auto poses = scene.poses(0);
  const clearance::point_span cloud(points);
  const clearance::placed<clearance::point_span> placed{cloud, scene.world_from_cloud};
  const auto view = model.view();
  const clearance::frames::cloud_frame frame(view.facts, poses, scene.world_from_cloud);
  const double reference =
      clearance::ask(clearance::host{.threads = 1}, model, poses, placed, clearance::min_distance{}).distance;

  out.begin("competitors", scene.name, count);
  if (quick) out.expect("brute force", brute_force(model, frame, cloud), reference);
  double found = 0;
  const auto measure = [&](const std::string& name, auto ask, int least = 3) {
    out.times(name, repeat([&] { return host_time([&] { found = ask(); }); }, host_budget, least));
    out.expect(name, found, reference);
  };
  measure(
      "CPU Algorithm 1 (1 thread)", [&] { return sequential(binary.view(), frame, cloud, clearance::recursive{}); }, 1);
  out.row("CPU ours (all threads)", "threads", std::thread::hardware_concurrency());
#ifdef CLEARANCE_BENCH_SIMD
  const auto wide = make_wide_trees(view);
#endif
  for (const unsigned threads : {1u, 2u, 0u}) {
    const clearance::host cpu{.threads = threads};
    const std::string how =
        " (" + (threads == 0 ? std::string("all") : std::to_string(threads)) + " thread" + (threads == 1 ? ")" : "s)");
    clearance::query query(cpu, model, clearance::min_distance{});
    query(poses, placed);
    measure("CPU ours" + how, [&] { return query(poses, placed).distance; });
#ifdef CLEARANCE_BENCH_SIMD
    if (threads == 2) continue;
    measure("CPU SIMD, eight points" + how, [&] { return eight_points(cpu, binary.view(), frame, cloud); });
    measure("CPU SIMD, eight children" + how, [&] { return eight_children(cpu, view, wide, frame, cloud); });
    measure("CPU SIMD, both" + how, [&] { return eight_of_each(cpu, view, wide, frame, cloud); });
#endif
  }
#ifdef CLEARANCE_BENCH_OCTOMAP
  using tree_of_points = octree<typename Model::view_type>;
  std::optional<tree_of_points> tree;
  std::vector<double> builds;  // for a new cloud: first the tree, then the query
  const auto whole = [&] {
    tree.reset();
    builds.push_back(host_time([&] { tree.emplace(cloud, frame.origin, scene.cell); }));
    return builds.back() + host_time([&] { found = tree->distance(view, frame); });
  };
  const std::vector<double> both = repeat(whole, host_budget, 1);
  out.times("CPU octree construction", {builds.end() - std::ptrdiff_t(both.size()), builds.end()});
  out.times("CPU octree construction and query", both);
  out.expect("CPU octree construction and query", found, reference);
  measure("CPU octree query", [&] { return tree->distance(view, frame); });
#endif
}

/// The distances along the robot's run, and our time for them on one thread.
template <class Model>
void host_along_motion(report& out, const scenario& scene, std::size_t count, const Model& model, int steps,
                       int passes) {
  const auto points = scene.points(count);
  const clearance::placed<clearance::point_span> placed{clearance::point_span(points), scene.world_from_cloud};
  clearance::query query(clearance::host{.threads = 1}, model, clearance::min_distance{});
  for (int step = 0; step < steps; ++step) {
    const auto poses = scene.poses(double(step) / (steps - 1));
    out.begin("motion", scene.name, count, step);
    const double reference =
        clearance::ask(clearance::host{}, model, poses, placed, clearance::min_distance{}).distance;
    out.row("distance", "m", reference);
    if (quick) {
      const clearance::frames::cloud_frame frame(model.view().facts, poses, scene.world_from_cloud);
      out.expect("brute force", brute_force(model, frame, placed.source), reference);
    }
    std::vector<double> times;
    for (int pass = 0; pass < passes; ++pass) {
      double found = 0;
      times.push_back(host_time([&] { found = query(poses, placed).distance; }));
      out.expect("CPU ours (1 thread)", found, reference);
    }
    out.times("CPU ours (1 thread)", times);
  }
}

}  // namespace bench::paper
