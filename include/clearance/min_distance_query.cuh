// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/backend/device.cuh>
#include <clearance/backend/pinned_buffer.cuh>
#include <clearance/min_distance_query.hpp>
#include <clearance/stream/stream_kernel.cuh>

#include <optional>

namespace clearance {

/// The prepared query on a device, for trees of ours: one kernel a frame, no allocation and no synchronisation after the
/// first call of a size. The answer equals min_distance's to the bit.
template <bounding_volume V, primitive P, class Interior>
class min_distance_query<device, part_view<bvh_view<V, P>, Interior>> {
 public:
  using view_type = part_view<bvh_view<V, P>, Interior>;

  min_distance_query(const device& on, model_view<view_type> model)
      : on_(on), facts_(model.facts.begin(), model.facts.end()), parts_(on.copy_out(model.parts, model.size())),
        answer_(1, on.id) {
    if (model.size() > stream::most_parts)
      throw std::invalid_argument("clearance::min_distance_query: " + std::to_string(model.size()) + " parts, but at most " +
                                  std::to_string(stream::most_parts) + " on a device; use min_distance");
    int processors = 0;
    check_cuda(cudaDeviceGetAttribute(&processors, cudaDevAttrMultiProcessorCount, on.id), "cudaDeviceGetAttribute");
    most_blocks_ = unsigned(processors) * 2;
    records_ = device_buffer<stream::record>(most_blocks_, on.id);
    if (parts_.size() > inline_parts) more_ = device_buffer<stream::stream_part<view_type>>(parts_.size() - inline_parts, on.id);
    for (const view_type& part : parts_) roots_.push_back(on.copy_out(part.tree.nodes, 1)[0]);
    forget();
    answer_.data()->done = 0;
  }
  template <class Model>
  min_distance_query(const device& on, const Model& model) : min_distance_query(on, model.view()) {}

  /// Drops what is known of the last frame. The next one starts cold; its answer is the same.
  void forget() {
    const stream::frame_state fresh;
    state_ = on_.copy_in(std::span(&fresh, 1));
  }

  /// Enqueues one frame; `result` is device or pinned memory. `cloud` must be readable on the device until it is done.
  template <point_source S>
  void enqueue(std::span<const Eigen::Isometry3d> poses, const S& source, const Eigen::Isometry3d& cloud_pose,
               min_distance_result* result, std::uint32_t* done = nullptr) {
    const device_guard guard(on_.id);
    const auto args = prepare(poses, source.size(), rigid(cloud_pose, "the cloud"), result, done);
    constexpr unsigned a_block = stream::block_threads * 4;
    const unsigned blocks = std::max(1u, std::min(most_blocks_, (args.points + a_block - 1) / a_block));
    stream::stream_kernel<<<blocks, stream::block_threads, 0, on_.stream>>>(source, args);
    check_cuda(cudaGetLastError(), "kernel launch");
  }

  /// One frame, waited for. Points in memory that the device cannot read are copied into a buffer that is kept.
  template <point_source S>
  min_distance_result operator()(std::span<const Eigen::Isometry3d> poses, const S& source,
                                 const Eigen::Isometry3d& cloud_pose = Eigen::Isometry3d::Identity()) {
    ++frame_;
    enqueue(poses, readable(source), cloud_pose, &answer_.data()->result, &answer_.data()->done);
    const volatile std::uint32_t& done = answer_.data()->done;
    for (unsigned spins = 1; done != frame_; ++spins)
      if (spins % 4096 == 0 && cudaStreamQuery(on_.stream) != cudaErrorNotReady && done != frame_) on_.wait();
    return answer_.data()->result;
  }
  template <point_source S>
  min_distance_result operator()(std::span<const Eigen::Isometry3d> poses, const placed<S>& cloud) {
    return (*this)(poses, cloud.source, cloud.pose);
  }
  min_distance_result operator()(std::span<const Eigen::Isometry3d> poses, const std::vector<vec3>& points) {
    return (*this)(poses, point_span(points));
  }

 private:
  static constexpr std::uint32_t inline_parts = stream::inline_parts;
  struct answer {
    min_distance_result result;
    std::uint32_t done;
  };

  stream::frame_args<view_type> prepare(std::span<const Eigen::Isometry3d> poses, std::size_t points,
                                        const Eigen::Isometry3d& world_from_cloud, min_distance_result* result, std::uint32_t* done) {
    if (poses.size() != parts_.size())
      throw std::invalid_argument("clearance::min_distance_query: there are " + std::to_string(parts_.size()) + " parts, but " +
                                  std::to_string(poses.size()) + " poses");
    if (points >= none - stream::block_threads * 4 * most_blocks_)
      throw std::invalid_argument("clearance::min_distance_query: " + std::to_string(points) + " points are too many for one call");
    stream::frame_args<view_type> a;
    a.points = std::uint32_t(points), a.parts = std::uint32_t(parts_.size());
    const search::cloud_frame frame(facts_, poses, world_from_cloud);
    a.origin = frame.origin, a.error = frame.error, a.slop = frame.slop;
    a.world_from_cloud = world_transform(world_from_cloud);
    a.state = state_.data(), a.records = records_.data(), a.result = result, a.done = done, a.frame = frame_;
    std::vector<stream::stream_part<view_type>> rest;
    for (std::uint32_t k = 0; k < a.parts; ++k) {
      const stream::stream_part<view_type> part{frame.places[k], roots_[k], parts_[k]};
      if (k < inline_parts)
        a.part[k] = part;
      else
        rest.push_back(part);
    }
    a.more = more_.data();
    on_.stage(std::span<const stream::stream_part<view_type>>(rest), more_.data());
    return a;
  }

  template <point_source S>
  S readable(const S& source) {
    if constexpr (requires { source.at(source.bytes().data()); }) {
      const auto bytes = source.bytes();
      if (!bytes.empty() && !on_.reads(bytes.data())) {
        if (input_.size() < bytes.size()) input_ = device_buffer<std::byte>(bytes.size(), on_.id);
        const device_guard guard(on_.id);
        check_cuda(cudaMemcpyAsync(input_.data(), bytes.data(), bytes.size(), cudaMemcpyHostToDevice, on_.stream), "cudaMemcpyAsync");
        return source.at(input_.data());
      }
    }
    return source;
  }

  device on_;
  std::vector<part_facts> facts_;
  std::vector<view_type> parts_;
  std::vector<bvh_node> roots_;
  unsigned most_blocks_ = 0;
  std::uint32_t frame_ = 0;
  device_buffer<stream::frame_state> state_;
  device_buffer<stream::record> records_;
  device_buffer<stream::stream_part<view_type>> more_;
  device_buffer<std::byte> input_;
  pinned_buffer<answer> answer_;
};

}  // namespace clearance
