// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/backend/one_call.cuh>
#include <clearance/frame/readable.cuh>
#include <clearance/plan/configurations.hpp>
#include <clearance/plan/device_batch.cuh>

namespace clearance::minimum {

/// A question about many configurations on a device, and their poses. The prepared questions inherit from it.
template <class PartView, class Question>
class placed_batch {
 public:
  /// Keeps poses, also on the device, for later frames: a watched trajectory is copied once. Enqueued. Throws
  /// std::invalid_argument if the last configuration is not whole.
  void place(std::span<const Eigen::Isometry3d> poses) {
    asked_ = detail::count_configurations(search_.parts(), poses.size());
    search_.place(poses);
    poses_.assign(poses.begin(), poses.end());
  }
  /// Keeps the poses of joint vectors, one after another, which the device computes. Throws std::invalid_argument as
  /// joint_chain::count, and if the chain belongs to another robot. Not for a graph: it copies from host memory.
  void place(const joint_chain<device>& chain, std::span<const double> q) {
    const std::size_t count = chain.count(q);
    if (there_.size() < q.size()) there_ = device_buffer<double>(q.size(), on_.id, memory_);
    q_.assign(q.begin(), q.end());
    if (!q.empty()) {
      const device_guard guard(on_.id);
      check_cuda(cudaMemcpyAsync(there_.data(), q_.data(), q.size_bytes(), cudaMemcpyHostToDevice, on_.stream),
                 "cudaMemcpyAsync");
    }
    place(chain, there_.data(), count);
  }
  /// The same for joint vectors in device memory. A vector that is not finite or beyond its limits makes poses that are
  /// not rigid.
  void place(const joint_chain<device>& chain, const double* q, std::size_t configurations) {
    detail::check_chain(search_.parts(), chain.parts());
    poses_.clear();
    asked_ = configurations;
    search_.place(std::uint32_t(configurations), [&](world_transform* there) {
      on_.for_each(configurations * chain.parts(), place_links{chain.view(), q, there});
    });
  }

 protected:
  placed_batch(const device& on, const model_view<PartView>& model, bool each_part, std::pmr::memory_resource* memory)
      : on_(on),
        memory_(memory),
        search_(on, model, each_part, memory),
        copies_(on, memory),
        there_(0, on.id, memory) {}

  /// Throws std::logic_error if the last configurations could not be placed.
  void check_placed() const {
    if (search_.placed() != asked_) throw std::logic_error("clearance: the last configurations could not be placed");
  }
  /// Waits, and copies the results to `to`. Throws std::invalid_argument if a pose is not rigid.
  void copy_out(std::vector<typename Question::result_type>& to, point_counts* counts = nullptr) const {
    to.resize(std::size_t(search_.placed()) * search_.robots());
    if (search_.copy_out(to, counts)) return;
    throw std::invalid_argument(
        poses_.empty()
            ? "clearance: a joint vector is not finite or beyond its joint's limits, or moves a part out of the world"
            : "clearance: a pose is not rigid");
  }
  template <class F>
  void named(const F& f) const {
    detail::named(search_.parts(), poses_, f);
  }

  device on_;
  std::pmr::memory_resource* memory_;
  device_batch<PartView, Question> search_;
  frames::kept_copies copies_;

 private:
  std::vector<Eigen::Isometry3d> poses_;  ///< Host copies, for error messages.
  std::size_t asked_ = 0;
  std::vector<double> q_;  ///< Joint vectors on their way,
  device_buffer<double> there_;
};

}  // namespace clearance::minimum
