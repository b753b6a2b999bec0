// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// One cloud on the GPU, the robot in one configuration, and how to time, check and count a method on them.

#include "device_clock.cuh"
#include "kernel.cuh"
#include "report.hpp"
#include "scenes.hpp"
#include "sequential.hpp"

#include <clearance/device.cuh>
#include <clearance/questions/min_distance.hpp>
#include <clearance/traversal/recursive.hpp>
#include <clearance/traversal/stack.hpp>

#include <optional>

namespace bench::paper {

/// Seconds to measure one variant.
inline double budget = 0.06;

class lab {
 public:
  explicit lab(report& out) : out(out), bound_(1, gpu.id), counts_(1, gpu.id), never_(1, gpu.id) {
    const std::uint32_t infinite = clearance::ordered(clearance::infinity);
    infinite_ = gpu.copy_in(std::span(&infinite, 1));
    check_cuda(cudaDeviceSetLimit(cudaLimitStackSize, clearance::recursive::device_stack(24)), "cudaDeviceSetLimit");
  }

  report& out;
  clearance::device gpu;
  device_clock clock;
  part_streams streams;

  const scenario* scene = nullptr;
  std::vector<clearance::vec3> points;
  std::optional<clearance::device_buffer<clearance::vec3>> there;
  std::vector<Eigen::Isometry3d> poses;

  void set(const scenario& s, std::size_t count) {
    scene = &s, points = s.points(count), poses = s.poses(0);
    there.reset();
    there.emplace(gpu.copy_in(std::span<const clearance::vec3>(points)));
  }

  clearance::point_span cloud() const { return {there->data(), points.size()}; }

  /// min_distance on the host, which everyone must match.
  template <class Model>
  double reference(const Model& model) const {
    const clearance::placed<clearance::point_span> placed{points, scene->world_from_cloud};
    const double least = clearance::ask(clearance::host{}, model, poses, placed, clearance::min_distance{}).distance;
    if (quick)
      out.expect("brute force",
                 brute_force(model, clearance::frames::cloud_frame(model.view().facts, poses, scene->world_from_cloud),
                             placed.source),
                 least);
    return least;
  }

  /// A model on the device, in the form for the paper's kernel.
  template <class Model>
  auto parts(const Model& model) const {
    return parts(model, gpu.copy_out(model.view().parts, model.size()));
  }
  template <class Model, class View>
  auto parts(const Model& model, const std::vector<View>& views) const {
    const clearance::frames::cloud_frame frame(model.view().facts, poses, scene->world_from_cloud);
    const Eigen::Isometry3d shift(Eigen::Translation3d(frame.origin.x, frame.origin.y, frame.origin.z));
    parts_at<decltype(View::tree)> all;
    if (model.size() > all.most) throw std::runtime_error("too many parts for this benchmark");
    for (const auto& v : views) {
      const auto& place = frame.places[all.count];
      const Eigen::Isometry3d cloud_from_part =
          (poses[all.count].inverse() * scene->world_from_cloud * shift).inverse();
      all.part[all.count++] = {v.tree, place.part_from_cloud, clearance::to_floats(cloud_from_part), place.around};
    }
    all.origin = frame.origin;
    return all;
  }

  /// Resets the bound to `from`; kernels are timed without this.
  void reset(real from) const {
    const std::uint32_t start = clearance::ordered(from);
    check_cuda(cudaMemcpy(bound_.data(), &start, sizeof start, cudaMemcpyHostToDevice), "cudaMemcpy");
  }
  /// To infinity, in the order of the default stream.
  void enqueue_reset() const {
    check_cuda(
        cudaMemcpyAsync(bound_.data(), infinite_.data(), sizeof(std::uint32_t), cudaMemcpyDeviceToDevice, nullptr),
        "cudaMemcpyAsync");
  }
  std::uint32_t* bound() const { return bound_.data(); }
  double found() const { return clearance::from_ordered(gpu.copy_out(bound_)[0]); }

  /// Times `enqueue`, resetting the bound before each run, and checks its result. Returns the median.
  template <class F>
  double time(const std::string& variant, F enqueue, double reference, double tolerance = 0,
              real from = clearance::infinity) {
    const auto once = [&] {
      reset(from);
      return clock.microseconds(enqueue);
    };
    once();
    auto all = repeat(once, budget, 5);
    out.expect(variant, found(), reference, tolerance);
    out.times(variant, all);
    std::nth_element(all.begin(), all.begin() + std::ptrdiff_t(all.size() / 2), all.end());
    return all[all.size() / 2];
  }
  template <class Method, class Parts>
  double time_method(const std::string& variant, const Method& m, const Parts& p, double reference) {
    return time(variant, [&] { m.enqueue(streams, p, cloud(), bound(), nullptr); }, reference);
  }

  /// The times of a kernel that only reads the points, and of one that does nothing.
  void floors() {
    out.begin("floor", scene->name, points.size());
    const auto read = [&](std::size_t n) {
      return repeat(
          [&] {
            return clock.microseconds(
                [&] { read_kernel<><<<264, 512>>>(reinterpret_cast<const float4*>(there->data()), n, never_.data()); });
          },
          budget);
    };
    out.times("empty kernel", read(0));
    out.times("read", read(points.size() * 3 / 4));
  }

  /// Counts instead of timing: node tests, leaf tests and accepted updates of the bound, per point of the cloud.
  template <class Method, class Parts>
  void count(const std::string& variant, const Method& m, const Parts& p, double reference,
             real from = clearance::infinity) {
    reset(from);
    check_cuda(cudaMemset(counts_.data(), 0, sizeof(counts)), "cudaMemset");
    m.enqueue(streams, p, cloud(), bound(), counts_.data());
    const counts all = gpu.copy_out(counts_)[0];
    out.expect(variant, found(), reference);
    write(variant, all);
  }
  void write(const std::string& variant, const counts& all) {
    const auto n = double(points.size());
    out.row(variant, "node_tests", double(all.tests) / n);
    out.row(variant, "leaf_tests", double(all.leaves) / n);
    out.row(variant, "updates", double(all.accepted) / n);
  }

  /// Ours: the prepared query, cold (nothing is known about a last frame) or warm. Returns the median.
  template <class Query, class Source>
  double time_ours(const std::string& variant, Query& query, const Source& source, bool cold, double reference) {
    const clearance::device_buffer<clearance::min_distance_result> result(1, gpu.id);
    const auto once = [&] {
      if (cold) query.forget();
      return clock.microseconds(
          [&] { query.enqueue(poses, clearance::placed<Source>{source, scene->world_from_cloud}, result.data()); });
    };
    once();
    auto all = repeat(once, budget, 5);
    out.expect(variant, gpu.copy_out(result)[0].distance, reference);
    out.times(variant, all);
    std::nth_element(all.begin(), all.begin() + std::ptrdiff_t(all.size() / 2), all.end());
    return all[all.size() / 2];
  }

 private:
  clearance::device_buffer<std::uint32_t> bound_, infinite_;
  clearance::device_buffer<counts> counts_;
  clearance::device_buffer<float> never_;
};

using paper_method = method<shared_by_all, clearance::recursive>;

}  // namespace bench::paper
