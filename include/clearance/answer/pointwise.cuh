// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Every point's own distance on a device.

#include <clearance/answer/pointwise.hpp>
#include <clearance/scan/launch.cuh>
#include <clearance/scan/packet_kernel.cuh>

namespace clearance::pointwise {

template <class PartView>
struct points_of {
  using part_type = PartView;
  using hierarchy_type = typename PartView::hierarchy_type;
  using scan_type = scan::by_packets;
  using block = scan::packet_memory<points_of>;
  static constexpr bool bound_per_part = true;
  static constexpr std::size_t top_bytes = 14016;

  struct arguments {
    distances_out out;
    real d_max;
    std::uint32_t first_part;  ///< Number of the kernel's first part; if it is not 0, other kernels have written before.
    point_counts* counts;      ///< Or null.
  };
  struct memory {
    __device__ void clear(std::uint32_t) {}
  };

  /// Of one lane's point.
  struct visitor_type {
    real limit;
    std::uint32_t before;
    found best;

    __device__ real reach(std::uint32_t) const { return min(limit, best.distance); }
    __device__ void offer(std::uint32_t k, std::uint32_t id, real distance) { best.offer({distance, before + k, id}); }
    __device__ void offer_inside(std::uint32_t k) {
      if (reach(k) >= 0) best.offer({0, before + k, none});
    }
  };

  static __device__ real reach_of_part(const block& s, std::uint32_t, std::uint32_t) { return s.head.answer.d_max; }

  static __device__ visitor_type visitor(const block& s, std::uint32_t index, bool counts) {
    const arguments& a = s.head.answer;
    return {a.d_max, a.first_part, a.first_part != 0 && counts ? read(a.out, index) : found{}};
  }
  static __device__ void take(const block& s, std::uint32_t index, bool counts, const visitor_type& v) {
    const real nothing = s.rigid && counts ? v.best.distance : not_a_number;
    write(s.head.answer.out, index, {nothing, v.best.part, v.best.primitive});
  }

  template <class Source>
  static __device__ void hand_in(const scan::scan_arguments<points_of>&, const Source&) {}
  template <class Source>
  static __device__ void conclude(const scan::scan_arguments<points_of>& a, const Source&) {
    scan::write_counts(a, a.answer.counts);
  }
  static __device__ void reset(const scan::scan_arguments<points_of>&) {}
};

/// Every point's distance on a device, frame after frame, one kernel a cloud: nothing is allocated and nothing waited for.
template <class PartView>
class device_points {
 public:
  device_points(const device& on, const model_view<PartView>& model, std::pmr::memory_resource* memory = nullptr)
      : facts_(model.facts.begin(), model.facts.end()), launch_(on, model, memory) {}

  /// What is certain of the distances, which are there once the stream has come so far. `here(source, cloud)` is what the device can
  /// read of a cloud.
  template <class Clouds, class Here>
  distance_certainty enqueue(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const distances_out& out, real d_max, point_counts* counts,
                             const Here& here) {
    return certainty_of(launch_.template pass<points_of<PartView>>(
        facts_, poses, clouds,
        [&](std::uint32_t group) {
          return typename points_of<PartView>::arguments{out, d_max, group * scan::most_parts, group == 0 ? counts : nullptr};
        },
        here));
  }

 private:
  std::vector<part_facts> facts_;
  scan::launcher<PartView> launch_;
};

}  // namespace clearance::pointwise
