// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/backend/pinned_buffer.cuh>
#include <clearance/backend/staging_ring.cuh>
#include <clearance/minimum/chunked_search.hpp>
#include <clearance/minimum/device_search.cuh>
#include <clearance/scan/boxes.cuh>

#include <optional>

namespace clearance::minimum {

/// On a device: chunks go through a ring, and a kernel searches one while the next is copied. A cloud on the device is
/// read where it is.
template <class PartView>
class chunked_search<device, PartView> {
 public:
  chunked_search(const device& on, const model_view<PartView>& model)
      : on_(on), search_(on, model), ring_(on), answer_(1, on.id), minima_(search_.parts(), on.id) {
    on_.wait();
  }

  std::size_t parts() const { return search_.parts(); }

  template <class C>
  void operator()(const chunked<C>& chunks, const std::vector<point_range>& ranges,
                  std::span<const Eigen::Isometry3d> poses, const Eigen::Isometry3d& pose, min_distance_result& result,
                  std::span<part_minimum> minima, std::vector<scan::boxed_piece>* seen) {
    try {
      if (minima.empty())
        search<false>(chunks.cloud(), ranges, poses, pose, seen);
      else
        search<true>(chunks.cloud(), ranges, poses, pose, seen);
      ring_.wait();
    } catch (...) {
      finish();
      throw;
    }
    result = *answer_.data();
    std::copy_n(minima_.data(), minima.size(), minima.begin());
    number_as_in_cloud(result, minima,
                       [&](std::uint32_t k, std::uint32_t i) { return std::uint32_t(ranges[k].begin) + i; });
  }

 private:
  template <bool PerPart, class C>
  void search(const C& cloud, const std::vector<point_range>& ranges, std::span<const Eigen::Isometry3d> poses,
              const Eigen::Isometry3d& pose, std::vector<scan::boxed_piece>* seen) {
    using S = loaded_source<C>;
    static_assert(
        requires(const S s) { s.at(s.bytes().data()); },
        "a source that does not say where its bytes are cannot be copied to a device");
    if (seen != nullptr && boxes_.size() < seen->size())
      boxes_ = {}, boxes_ = device_buffer<scan::boxed_piece>(seen->size(), on_.id);
    std::size_t pinned = 0;
    for (const point_range& r : ranges) pinned = std::max(pinned, cloud.room(r.end - r.begin));
    ring_.need(pinned, 0);
    std::optional<S> there;
    const auto done = [&](std::size_t k) {
      if (seen != nullptr && there)
        scan::enqueue_boxes(on_, *there, boxes_.data() + ranges[k].begin / scan::piece_points);
      ring_.read(k);
    };
    const auto load = [&](std::size_t k) { return placed<S>{load_range(cloud, ranges[k], ring_.fill(k)), pose}; };
    const auto here = [&]<class Its>(const Its& source, std::uint32_t k) {
      if constexpr (std::is_same_v<Its, S>) {
        if (k > 0) done(k - 1);
        const auto bytes = source.bytes();
        const bool is_there = bytes.empty() || on_.holds(bytes.data());
        if (!is_there) ring_.need(0, bytes.size() + 512);  // pieces of a copy begin at multiples of 256
        there.emplace(is_there ? source : source.at(ring_.copy(k, bytes)));
        return *there;
      } else {
        return source;  // of no ranges, no points
      }
    };
    search_.template enqueue<PerPart>(poses, as_they_come(ranges.size(), load), answer_.data(), minima_.data(), here);
    if (!ranges.empty()) done(ranges.size() - 1);
    if (seen == nullptr || seen->empty()) return;
    const device_guard guard(on_.id);
    check_cuda(cudaMemcpyAsync(seen->data(), boxes_.data(), seen->size() * sizeof(scan::boxed_piece),
                               cudaMemcpyDeviceToHost, on_.stream),
               "cudaMemcpyAsync");
  }

  /// Whatever has gone wrong: nothing reads or writes any more.
  void finish() const noexcept {
    try {
      ring_.wait();
    } catch (...) {  // what is told is what went wrong first
    }
  }

  device on_;
  device_search<PartView> search_;
  staging_ring ring_;
  pinned_buffer<min_distance_result> answer_;
  pinned_buffer<part_minimum> minima_;
  device_buffer<scan::boxed_piece> boxes_;
};

}  // namespace clearance::minimum
