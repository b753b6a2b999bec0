// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/answer/batch_finish.cuh>
#include <clearance/answer/batch_kernel.cuh>
#include <clearance/answer/batch_place.cuh>
#include <clearance/answer/plain_search.hpp>
#include <clearance/cloud_tree/device_tree.cuh>
#include <clearance/frame/clouds.hpp>
#include <clearance/robot/model.hpp>

#include <bit>
#include <memory>
#include <utility>

namespace clearance::minimum {

/// The least distances of many configurations on a device, frame after frame: a tree over each cloud, and a block a configuration
/// down it. Nothing is waited for, and once there was a frame of a size nothing is allocated.
template <class PartView>
class device_batch {
 public:
  /// Throws std::invalid_argument if a tree is too deep for a thread's stack.
  device_batch(const device& on, const model_view<PartView>& model, std::pmr::memory_resource* memory = nullptr)
      : on_(on), model_(model), facts_(model.facts.begin(), model.facts.end()), memory_(memory), counts_(1, on.id, memory) {
    check_stack<near_first>(model.depth, model.width);
    model_.facts = facts_;
    anywhere_.assign(facts_.size(), Eigen::Isometry3d::Identity());
    check_cuda(cudaDeviceGetAttribute(&processors_, cudaDevAttrMultiProcessorCount, on.id), "cudaDeviceGetAttribute");
  }
  device_batch(const device_batch&) = delete;

  std::size_t parts() const { return facts_.size(); }
  std::uint32_t size() const { return configurations_; }
  const min_distance_result* results() const { return results_.data(); }

  /// Results, and whether all poses were rigid; waits.
  bool copy_out(std::span<min_distance_result> to) const {
    if (to.empty()) return true;
    const device_guard guard(on_.id);
    counts found;
    const auto copy = [&](void* there, const void* from, std::size_t bytes) {
      check_cuda(cudaMemcpyAsync(there, from, bytes, cudaMemcpyDeviceToHost, on_.stream), "cudaMemcpyAsync");
    };
    copy(to.data(), results_.data(), to.size_bytes());
    copy(&found, counts_.data(), sizeof found);
    on_.wait();
    return found.lost == 0;
  }

  /// Enqueues a copy of poses, those of a configuration after another, for all frames to come.
  void place(std::span<const Eigen::Isometry3d> poses) {
    const auto count = std::uint32_t(poses.empty() ? 0 : poses.size() / facts_.size());
    staged_.clear();
    for (const Eigen::Isometry3d& pose : poses) staged_.emplace_back(pose);
    const std::size_t n = staged_.size();
    const std::uint32_t before = std::exchange(configurations_, 0);  // so that nothing is asked of poses that were not placed
    grow(poses_, n), grow(places_, n), grow(bounds_, n);
    grow(of_all_, count), grow(all_, count), grow(seeds_, count), grow(results_, count), grow(last_, count);
    if (n == 0) return;
    const device_guard guard(on_.id);
    check_cuda(cudaMemcpyAsync(poses_.data(), staged_.data(), n * sizeof staged_[0], cudaMemcpyHostToDevice, on_.stream), "cudaMemcpyAsync");
    if (count != before) clear(last_.data(), 0xff, count);  // no cloud's
    configurations_ = count;
  }

  /// Enqueues a frame. `here(source, cloud)` is what the device can read of a cloud.
  template <class Clouds, class Here>
  void enqueue(const Clouds& clouds, real d_max, const Here& here) {
    if (configurations_ == 0) return;
    clear(counts_.data(), 0, 1);
    frames::for_each_turn(frame_, facts_, anywhere_, clouds, [&](const auto& given, const frames::turn& now) {
      const auto source = here(given, now.cloud);
      while (trees_.size() <= now.cloud) trees_.push_back(std::make_unique<cloud_tree::device_tree>(on_, memory_));
      trees_[now.cloud]->build(source, &counts_.data()->dropped);
      ask(source, trees_[now.cloud]->view(), now, d_max);
    });
  }

  void forget() {
    if (configurations_ != 0) clear(last_.data(), 0xff, configurations_);  // no cloud's
  }

 private:
  using arguments = batch_arguments<PartView>;
  struct counts {
    scan::drop_counts dropped;
    std::uint32_t lost = 0;
  };

  template <point_source S>
  void ask(const S& source, const cloud_tree::device_tree::view_type& tree, const frames::turn& now, real d_max) {
    const arguments a{model_.parts,   std::uint32_t(facts_.size()), configurations_,     poses_.data(),  now,            frame_.world_from_cloud,
                      rounding_of(source), d_max,                   now.first + source.size(), places_.data(), bounds_.data(), of_all_.data(),
                      all_.data(),    last_.data(),                 seeds_.data(),       results_.data(), &counts_.data()->dropped, &counts_.data()->lost};
    const unsigned blocks = (configurations_ + 3) / 4;
    on_.launch(place_configurations<PartView, S>, blocks, 128, 0, a, source);
    // As many threads as a device has room for: of few configurations each gets more.
    unsigned threads = std::clamp(std::bit_floor(2048 * unsigned(processors_) / configurations_), 128u, 512u);
    using room = batch_room<node_pair<typename PartView::hierarchy_type::node_type>>;
    while (room::bytes(threads) > 48 * 1024) threads /= 2;  // as much as a block always has
    on_.launch(batch_kernel<PartView, cloud_tree::device_tree::view_type>, configurations_, threads, room::bytes(threads), a, tree);
    on_.launch(finish_configurations<PartView, S>, blocks, 128, 0, a, source);
  }

  template <class T>
  void grow(device_buffer<T>& buffer, std::size_t n) const {
    if (buffer.size() < n) buffer = device_buffer<T>(n, on_.id, memory_);
  }
  template <class T>
  void clear(T* what, int byte, std::size_t n) const {
    const device_guard guard(on_.id);
    check_cuda(cudaMemsetAsync(what, byte, n * sizeof(T), on_.stream), "cudaMemsetAsync");
  }

  device on_;
  model_view<PartView> model_;
  std::vector<part_facts> facts_;
  std::pmr::memory_resource* memory_;
  int processors_ = 0;
  std::uint32_t configurations_ = 0;
  std::vector<world_transform> staged_;
  std::vector<Eigen::Isometry3d> anywhere_;  ///< Poses, so that clouds are placed on the host: what is made of them is not used.
  frames::cloud_frame frame_;
  std::vector<std::unique_ptr<cloud_tree::device_tree>> trees_;
  device_buffer<world_transform> poses_;
  device_buffer<frames::placement> places_;
  device_buffer<ball_bounds> bounds_;
  device_buffer<configuration_facts> of_all_;
  device_buffer<totals> all_;
  device_buffer<last_place> last_;
  device_buffer<cloud_tree::numbered_point> seeds_;
  device_buffer<min_distance_result> results_;
  device_buffer<counts> counts_;
};

}  // namespace clearance::minimum
