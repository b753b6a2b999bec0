// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// From points on the host to the minimum on the host: the paper's method, ours, and the octree with a GPU (Fig. 8, 9).

#include "host_competitors.hpp"
#include "lab.cuh"

#include <clearance/backends/device_buffer.cuh>

namespace bench::paper {

/// What one host thread enqueues and waits for, per frame; points are in pinned memory.
template <class Model, class Binary>
class frames {
 public:
  frames(lab& l, const Model& model, const Binary& binary)
      : l_(l),
        binary_(binary),
        views_(l.gpu.copy_out(binary.view().parts, binary.size())),
        query_(l.gpu, model, {}),
        pinned_(l.points.size(), l.gpu.id),
        filtered_(l.points.size() * model.size(), l.gpu.id),
        sets_(l.points.size() * model.size(), l.gpu.id) {
    std::copy(l.points.begin(), l.points.end(), pinned_.data());
  }

  clearance::point_span pinned() const { return {pinned_.data(), l_.points.size()}; }

  void copy(const clearance::vec3* from) const {
    check_cuda(cudaMemcpyAsync(l_.there->data(), from, l_.points.size() * sizeof(clearance::vec3),
                               cudaMemcpyHostToDevice, nullptr),
               "cudaMemcpyAsync");
  }

  /// The paper's: copy, one kernel per part in its stream, the bound back.
  double papers(const clearance::vec3* from) {
    l_.enqueue_reset();
    copy(from);
    paper_method{}.enqueue(l_.streams, l_.parts(binary_, views_), l_.cloud(), l_.bound(), nullptr);
    return l_.found();
  }

  /// Ours: reads the points where they are.
  double ours(const clearance::point_span& from) { return query_(l_.poses, from, l_.scene->world_from_cloud).distance; }

#ifdef CLEARANCE_BENCH_OCTOMAP
  /// The paper's octree + GPU: each part has its own filtered points, copied and tested in its own stream.
  template <class Tree, class View>
  double octree_then_gpu(Tree& tree, const View& host_model) {
    const clearance::frames::cloud_frame frame(host_model.facts, l_.poses, l_.scene->world_from_cloud);
    const auto sets = tree.filtered(host_model, frame);
    l_.enqueue_reset();
    auto parts = l_.parts(binary_, views_);
    parts.origin = {0, 0, 0};  // the octree's points are already relative to it
    std::vector<std::size_t> first = {0};
    for (const auto& set : sets) {
      std::copy(set.begin(), set.end(), filtered_.data() + first.back());
      first.push_back(first.back() + set.size());
    }
    l_.streams.fork(parts.count, [&](unsigned k, cudaStream_t on) {
      if (sets[k].empty()) return;
      check_cuda(cudaMemcpyAsync(sets_.data() + first[k], filtered_.data() + first[k],
                                 sets[k].size() * sizeof(clearance::vec3), cudaMemcpyHostToDevice, on),
                 "cudaMemcpyAsync");
      paper_method{}.launch(parts, k, k + 1, clearance::point_span(sets_.data() + first[k], sets[k].size()), l_.bound(),
                            nullptr, on);
    });
    copied_ = first.back();
    return l_.found();
  }
  std::size_t copied() const { return copied_; }
#endif

 private:
  lab& l_;
  const Binary& binary_;
  std::vector<typename Binary::view_type> views_;
  clearance::query<clearance::min_distance, clearance::device, typename Model::view_type> query_;
  clearance::pinned_buffer<clearance::vec3> pinned_, filtered_;
  clearance::device_buffer<clearance::vec3> sets_;
  std::size_t copied_ = 0;
};

/// Fig. 8 right, and the GPU's part of Fig. 9, for the lab's cloud.
template <class HostModel, class Model, class Binary>
void device_competitors(lab& l, const HostModel& on_host, const Model& model, const Binary& binary, double reference) {
  frames all(l, model, binary);
  const auto view = on_host.view();
  l.out.begin("transfer", l.scene->name, l.points.size());
  l.out.times("copy from pinned memory",
              repeat([&] { return l.clock.microseconds([&] { all.copy(all.pinned().points); }); }, budget));
  l.out.times("copy from pageable memory",
              repeat([&] { return l.clock.microseconds([&] { all.copy(l.points.data()); }); }, budget));
  l.time_method("the paper's kernels", paper_method{}, l.parts(binary), reference);
  clearance::query query(l.gpu, model, clearance::min_distance{});
  l.time_ours("our kernel, cold", query, l.cloud(), true, reference);
  l.time_ours("our kernel, warm", query, l.cloud(), false, reference);

  l.out.begin("competitors", l.scene->name, l.points.size());
  double found = 0;
  const auto measure = [&](const std::string& name, auto ask) {
    found = ask();
    l.out.times(name, repeat([&] { return host_time([&] { found = ask(); }); }, budget));
    l.out.expect(name, found, reference);
  };
  measure("GPU the paper's, pinned", [&] { return all.papers(all.pinned().points); });
  measure("GPU the paper's, pageable", [&] { return all.papers(l.points.data()); });
  measure("GPU ours, pinned", [&] { return all.ours(all.pinned()); });
  measure("GPU ours, pageable", [&] { return all.ours(l.points); });
  measure("GPU ours, resident", [&] { return all.ours(l.cloud()); });
#ifdef CLEARANCE_BENCH_OCTOMAP
  const clearance::frames::cloud_frame frame(view.facts, l.poses, l.scene->world_from_cloud);
  octree<typename HostModel::view_type> tree(clearance::point_span(l.points), frame.origin, l.scene->cell);
  measure("octree + GPU", [&] { return all.octree_then_gpu(tree, view); });
  l.out.row("octree + GPU", "copied_points", double(all.copied()));
#endif
}

struct runner {
  const char* name;
  std::function<double()> ask;
  int passes;
};

/// Fig. 8 left: time and distance along one run, step by step; each step is the median over its passes.
template <class HostModel, class Model, class Binary>
void along_motion(lab& l, const HostModel& on_host, const Model& model, const Binary& binary, int steps, int passes) {
  frames all(l, model, binary);
  const auto view = on_host.view();
#ifdef CLEARANCE_BENCH_OCTOMAP
  const clearance::frames::cloud_frame start(view.facts, l.scene->poses(0), l.scene->world_from_cloud);
  octree<typename HostModel::view_type> tree(clearance::point_span(l.points), start.origin, l.scene->cell);
#endif
  std::vector<runner> everybody = {{"GPU the paper's", [&] { return all.papers(all.pinned().points); }, passes},
                                   {"GPU ours", [&] { return all.ours(all.pinned()); }, passes},
                                   {"GPU ours, resident", [&] { return all.ours(l.cloud()); }, passes}};
#ifdef CLEARANCE_BENCH_OCTOMAP
  everybody.push_back({"CPU octree query",
                       [&] {
                         return double(tree.distance(
                             view, clearance::frames::cloud_frame(view.facts, l.poses, l.scene->world_from_cloud)));
                       },
                       3});
  everybody.push_back({"octree + GPU", [&] { return all.octree_then_gpu(tree, view); }, 3});
#endif
  std::vector<double> reference;
  for (int step = 0; step < steps; ++step) {
    l.poses = l.scene->poses(double(step) / (steps - 1));
    l.out.begin("motion", l.scene->name, l.points.size(), step);
    reference.push_back(l.reference(on_host));
    l.out.row("distance", "m", reference.back());
  }
  for (const runner& s : everybody) {
    std::vector<std::vector<double>> times(reference.size());
    for (int pass = 0; pass < s.passes; ++pass)
      for (int step = 0; step < steps; ++step) {
        l.poses = l.scene->poses(double(step) / (steps - 1));
        double found = 0;
        times[std::size_t(step)].push_back(host_time([&] { found = s.ask(); }));
        l.out.begin("motion", l.scene->name, l.points.size(), step);
        l.out.expect(s.name, found, reference[std::size_t(step)]);
      }
    for (int step = 0; step < steps; ++step) {
      l.out.begin("motion", l.scene->name, l.points.size(), step);
      l.out.times(s.name, times[std::size_t(step)]);
    }
  }
}

}  // namespace bench::paper
