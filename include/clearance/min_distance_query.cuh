// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/backend/device.cuh>
#include <clearance/backend/pinned_buffer.cuh>
#include <clearance/min_distance_query.hpp>
#include <clearance/stream/launch.cuh>

namespace clearance {

/// The prepared query on a device, for trees of ours: one kernel a cloud, no allocation and no synchronisation after the
/// first call. The answer equals min_distance's to the bit; with `minima`, every part's too, and a tighter `lower`.
///
/// Memory for its own use comes from `memory`, a resource that hands out device memory, if one is given.
template <bounding_volume V, primitive P, class Interior>
class min_distance_query<device, part_view<bvh_view<V, P>, Interior>> {
 public:
  using view_type = part_view<bvh_view<V, P>, Interior>;

  /// Throws std::invalid_argument if there are more than 128 parts, or trees that `build` would not make; min_distance takes any.
  min_distance_query(const device& on, model_view<view_type> model, std::pmr::memory_resource* memory = nullptr)
      : on_(on), memory_(memory), facts_(model.facts.begin(), model.facts.end()), launch_(on, model.size(), model.depth, model.width, memory),
        views_(model.size(), on.id, memory), answer_(1, on.id), minima_(model.size(), on.id) {
    const device_guard guard(on.id);
    check_cuda(cudaMemcpyAsync(views_.data(), model.parts, model.size() * sizeof(view_type), cudaMemcpyDeviceToDevice, on.stream), "cudaMemcpyAsync");
    on_.wait();
    answer_.data()->done = 0;
  }
  template <class Model>
  min_distance_query(const device& on, const Model& model, std::pmr::memory_resource* memory = nullptr)
      : min_distance_query(on, detail::view_of(model), memory) {}

  /// Drops what is known of the last frame. The next one starts cold; its answer is the same.
  void forget() { launch_.forget(); }

  /// Enqueues one frame. `clouds` as for min_distance, readable on the device until it is done; `result`, and `minima` (one
  /// a part, or null), in device or pinned memory. A graph that captures this keeps the poses of now.
  template <class Clouds>
  void enqueue(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, min_distance_result* result, part_minimum* minima = nullptr) {
    enqueue_all(poses, detail::as_clouds(clouds), result, minima, nullptr, [](const auto& source, std::uint32_t) { return source; });
  }
  template <point_source S>
  void enqueue(std::span<const Eigen::Isometry3d> poses, const S& source, const Eigen::Isometry3d& cloud_pose, min_distance_result* result,
               part_minimum* minima = nullptr) {
    enqueue(poses, placed<S>{source, cloud_pose}, result, minima);
  }

  /// Enqueues one frame with poses in device or pinned memory, read when the frame runs: one a part, and the cloud's (null:
  /// the world's). A graph that captures this sees what is there at each launch. If a pose is not rigid, which cannot be
  /// thrown there, the state is `possible` and the distance NaN.
  template <point_source S>
  void enqueue(const world_transform* poses, const S& source, const world_transform* cloud_pose, min_distance_result* result,
               part_minimum* minima = nullptr) {
    const device_guard guard(on_.id);
    auto a = launch_.first(views_.data(), result, minima, nullptr, 0);
    launch_.place(poses, cloud_pose, rounding_of(source), a);
    a.points = launch_.checked(source.size()), a.last = true;
    launch_(source, a);
  }

  /// One frame, waited for; `minima`, if not empty, one a part, are every part's own. Points in host memory, pinned ones too,
  /// are copied into buffers that are kept.
  template <class Clouds>
  min_distance_result operator()(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, std::span<part_minimum> minima = {}) {
    if (!minima.empty() && minima.size() != facts_.size())
      throw std::invalid_argument("clearance::min_distance_query: there are " + std::to_string(facts_.size()) + " parts, but room for " +
                                  std::to_string(minima.size()) + " minima");
    const std::uint32_t number = ++frame_number_;
    enqueue_all(poses, detail::as_clouds(clouds), &answer_.data()->result, minima.empty() ? nullptr : minima_.data(), &answer_.data()->done,
                [this](const auto& source, std::uint32_t cloud) { return readable(source, cloud); });
    const volatile std::uint32_t& done = answer_.data()->done;
    for (unsigned spins = 1; done != number; ++spins)
      if (spins % 4096 == 0 && cudaStreamQuery(on_.stream) != cudaErrorNotReady && done != number) on_.wait();
    std::copy_n(minima_.data(), minima.size(), minima.begin());
    return answer_.data()->result;
  }
  template <point_source S>
  min_distance_result operator()(std::span<const Eigen::Isometry3d> poses, const S& source, const Eigen::Isometry3d& cloud_pose) {
    return (*this)(poses, placed<S>{source, cloud_pose});
  }

 private:
  struct answer {
    min_distance_result result;
    std::uint32_t done;
  };

  /// `here(source, cloud)` gives a source that the device can read.
  template <class Clouds, class Here>
  void enqueue_all(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, min_distance_result* result, part_minimum* minima,
                   std::uint32_t* done, Here here) {
    if (poses.size() != facts_.size())
      throw std::invalid_argument("clearance::min_distance_query: there are " + std::to_string(facts_.size()) + " parts, but " +
                                  std::to_string(poses.size()) + " poses");
    if (clouds.size() == 0) throw std::invalid_argument("clearance::min_distance_query: there is no cloud");
    const device_guard guard(on_.id);
    auto a = launch_.first(views_.data(), result, minima, done, frame_number_);
    try {
      for (const auto& cloud : clouds) {
        frame_.put(facts_, poses, rigid_transform_of(cloud.pose, "cloud", a.cloud), rounding_of(cloud.source));
        frame_.error.widen(a.frame.error);  // the bracket is over all clouds
        a.frame = frame_;
        launch_.put(frame_.places, a);
        a.points = launch_.checked(std::uint64_t(cloud.source.size()) + a.first) - a.first;
        a.last = a.cloud + 1 == clouds.size();
        launch_(here(cloud.source, a.cloud), a);
        a.first += a.points, ++a.cloud;
      }
    } catch (...) {
      forget();  // the clouds before this one have left their bounds and minima
      throw;
    }
  }

  template <point_source S>
  S readable(const S& source, std::uint32_t cloud) {
    if constexpr (requires { source.at(source.bytes().data()); }) {
      const auto bytes = source.bytes();
      if (bytes.empty() || on_.holds(bytes.data())) return source;
      if (copies_.size() <= cloud) copies_.resize(cloud + 1);
      auto& copy = copies_[cloud];
      if (copy.size() < bytes.size()) copy = device_buffer<std::byte>(bytes.size(), on_.id, memory_);
      const device_guard guard(on_.id);
      check_cuda(cudaMemcpyAsync(copy.data(), bytes.data(), bytes.size(), cudaMemcpyHostToDevice, on_.stream), "cudaMemcpyAsync");
      return source.at(copy.data());
    }
    return source;
  }

  device on_;
  std::pmr::memory_resource* memory_;
  std::vector<part_facts> facts_;
  stream::launcher<view_type> launch_;
  device_buffer<view_type> views_;
  search::cloud_frame frame_;
  std::uint32_t frame_number_ = 0;
  std::vector<device_buffer<std::byte>> copies_;
  pinned_buffer<answer> answer_;
  pinned_buffer<part_minimum> minima_;
};

template <class Model>
min_distance_query(const device&, const Model&, std::pmr::memory_resource*) -> min_distance_query<device, typename Model::view_type>;

}  // namespace clearance
