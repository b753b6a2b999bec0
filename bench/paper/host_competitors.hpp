// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Everything on the CPU over the size of the cloud (the paper's Fig. 9): Algorithm 1, the octree with and without its
// construction, and ours.

#include "octree.hpp"
#include "report.hpp"
#include "scenes.hpp"
#include "sequential.hpp"

#include <clearance/min_distance_query.hpp>
#include <clearance/traversal/recursive.hpp>

namespace bench::paper {

/// Seconds that one competitor is measured for.
inline double host_budget = 0.15;

template <class Model>
void host_competitors(report& out, const scenario& scene, std::size_t count, const Model& model, const Model& binary) {
  const auto points = scene.points(count);
  const auto poses = scene.poses(0);
  const clearance::point_span cloud(points);
  const clearance::placed<clearance::point_span> placed{cloud, scene.world_from_cloud};
  const auto view = model.view();
  const clearance::frames::cloud_frame frame(view.facts, poses, scene.world_from_cloud);
  const double reference = clearance::min_distance(clearance::host{.threads = 1}, model, poses, placed).distance;

  out.begin("competitors", scene.name, count);
  double found = 0;
  const auto measure = [&](const std::string& name, auto ask, int least = 3) {
    out.times(name, repeat([&] { return host_time([&] { found = ask(); }); }, host_budget, least));
    out.expect(name, found, reference);
  };
  measure(
      "CPU Algorithm 1 (1 thread)", [&] { return sequential(binary.view(), frame, cloud, clearance::recursive{}); }, 1);
  for (const unsigned threads : {1u, 2u, 0u}) {
    const clearance::host cpu{.threads = threads};
    clearance::min_distance_query query(cpu, model);
    query(poses, placed);
    measure("CPU ours (" + (threads == 0 ? std::string("all") : std::to_string(threads)) + " thread" +
                (threads == 1 ? ")" : "s)"),
            [&] { return query(poses, placed).distance; });
  }
#ifdef CLEARANCE_BENCH_OCTOMAP
  using tree_of_points = octree<typename Model::view_type>;
  std::optional<tree_of_points> tree;
  const auto build = [&] {
    tree.reset();
    return host_time([&] { tree.emplace(cloud, frame.origin, scene.cell); });
  };
  out.times("CPU octree construction", repeat(build, host_budget, 1));
  measure("CPU octree query", [&] { return tree->distance(view, frame); });
#endif
}

}  // namespace bench::paper
