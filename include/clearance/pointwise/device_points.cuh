// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Each point's own distance on a device. It may remember the nearest primitives from frame to frame.

#include <clearance/backends/device.cuh>
#include <clearance/backends/readback.cuh>
#include <clearance/frames/readable.cuh>
#include <clearance/pointwise/each_point.hpp>
#include <clearance/pointwise/engine.hpp>
#include <clearance/scan/launch.cuh>
#include <clearance/scan/packet_kernel.cuh>

#include <optional>
#include <utility>

namespace clearance::pointwise {

/// The nearest primitive of a point: the part's number, or ~0u, and the primitive's place in its tree.
template <hierarchy H>
struct remembered {
  std::uint32_t part;
  typename scan::node_of<H>::place place;
};

template <class PartView, scan::packets_by How>
struct points_of {
  using part_type = PartView;
  using element = vec3;
  using hierarchy_type = typename PartView::hierarchy_type;
  using place_type = typename scan::node_of<hierarchy_type>::place;
  static constexpr scan::packets_by how = How;
  using scan_type = scan::by_packets;
  using block = typename scan::packet_walk<points_of, How>::memory;
  static constexpr bool bound_per_part = true, goes_ahead = false;
  static constexpr std::size_t top_bytes = 0;  ///< 32 points share each read of a node, so no copy is needed.

  struct arguments {
    distances_out out;
    real d_max;
    std::uint32_t first_part;          ///< The kernel's first part. If it is not 0, other kernels have written before.
    point_counts* counts;              ///< Or null.
    remembered<hierarchy_type>* last;  ///< Per point, the nearest in the last frame, then in this one; or null.
    const field_view* fields;          ///< One for each of the kernel's parts, or null.
  };
  struct memory {
    __device__ void clear(std::uint32_t) {}
  };

  /// The visitor of one lane's point.
  struct visitor_type {
    real limit;
    std::uint32_t before;
    found best;
    place_type at;  ///< Place of `best`, if it is a primitive of one of this kernel's parts.

    __device__ real reach(std::uint32_t) const { return min(limit, best.distance); }
    __device__ void offer(std::uint32_t k, const place_type& place, std::uint32_t id, real distance) {
      if (best.offer({distance, before + k, id})) at = place;
    }
    __device__ void offer_inside(std::uint32_t k) {
      if (reach(k) >= 0) best.offer({0, before + k, none});
    }
    __device__ bool hear(const visitor_type& other) {
      const real others = scan::fresh(other.best.distance);
      limit = min(limit, others);
      return best.distance < others;
    }
    __device__ void join(const visitor_type& other) {
      if (best.offer(other.best)) at = other.at;
    }
  };

  static constexpr __device__ bool bounds_differ(const block&) { return true; }
  static __device__ real reach_of_part(const block& s, std::uint32_t, std::uint32_t) { return s.head.answer.d_max; }

  /// True if no point is too far away to matter.
  static bool all_near(const arguments& a) { return a.d_max == infinity; }

  static __device__ visitor_type visitor(const block& s, std::uint32_t index, bool counts) {
    const arguments& a = s.head.answer;
    return {a.d_max, a.first_part, a.first_part != 0 && counts ? read(a.out, index) : found{}, {}};
  }
  /// Evaluates the last nearest primitive anew, or looks into the parts' fields. That gives only a bound, because the
  /// walk finds the nearest primitive and equally near ones again.
  static __device__ void remind(const block& s, std::uint32_t index, vec3 x, visitor_type& v) {
    const arguments& a = s.head.answer;
    if (a.last != nullptr) {
      const remembered<hierarchy_type> last = a.last[index];
      if (const std::uint32_t k = last.part - a.first_part; k < s.head.parts) {
        using parts = scan::tree_steps<points_of>;
        const real d = parts::primitive(k, last.place).distance(parts::place(k).part_from_cloud(x));
        if (d <= a.d_max) v.best.offer({d, none, none});
        return;
      }
    }
    if (a.fields == nullptr) return;
    if (const real high = foreseen(x); high <= a.d_max) v.best.offer({high, none, none});
  }
  /// The last nearest primitive, if it is of one of this kernel's parts.
  static __device__ scan::primitive_of_part known(const block& s, std::uint32_t index) {
    const arguments& a = s.head.answer;
    if (a.last == nullptr) return {none, 0};
    const remembered<hierarchy_type> last = a.last[index];
    if constexpr (std::is_same_v<place_type, std::uint32_t>)
      return {last.part == none ? none : last.part - a.first_part, last.place};
    return {none, 0};
  }
  static __device__ void take(const block& s, std::uint32_t index, bool counts, const visitor_type& v) {
    const arguments& a = s.head.answer;
    write(a.out, index, {s.rigid && counts ? v.best.distance : not_a_number, v.best.part, v.best.primitive});
    if (a.last == nullptr) return;
    const bool of_these = v.best.part != none && v.best.part >= a.first_part;
    if (of_these && v.best.primitive != none)
      a.last[index] = {v.best.part, v.at};
    else if (of_these || a.first_part == 0)
      a.last[index].part = none;
  }

  /// How far the nearest part at most is. Not inlined, so that it costs those nothing that have no fields.
  static __noinline__ __device__ real foreseen(vec3 x) {
    using parts = scan::frame_parts<points_of>;
    const auto& head = scan::memory_of_block<points_of>().head;
    real high = infinity;
    for (std::uint32_t k = 0; k < head.parts; ++k)
      if (const scan::frame_part& place = parts::place(k); frames::may_reach(place.root.around, high, x))
        high = min(high, head.answer.fields[k](place.part_from_cloud(x)).high);
    return high;
  }

  template <class Source>
  static __device__ void hand_in(const scan::scan_arguments<points_of>&, const Source&) {}
  template <class Source>
  static __device__ void conclude(const scan::scan_arguments<points_of>& a, const Source&) {
    scan::write_counts(a, a.answer.counts);
  }
  static __device__ void reset(const scan::scan_arguments<points_of>&) {}
};

/// Each point's distance on a device, frame after frame, with one kernel per cloud. It allocates nothing and never
/// waits. If it remembers the last frame, a frame with more points than any before allocates memory for that.
template <class PartView>
class device_points {
 public:
  device_points(const device& on, const model_view<PartView>& model, std::pmr::memory_resource* memory = nullptr,
                bool remembers = false)
      : on_(on),
        memory_(memory),
        remembers_(remembers),
        facts_(model.facts.begin(), model.facts.end()),
        launch_(on, model, memory) {}

  /// Enqueues a frame and returns how certain its distances are. `here(source, cloud)` is a source that the device can
  /// read.
  template <class Clouds, class Here>
  distance_certainty enqueue(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const distances_out& out,
                             real d_max, point_counts* counts, const Here& here) {
    if constexpr (cored_hierarchy<hierarchy_type>)
      if (launch_.has_cells()) return pass<scan::packets_by::cells>(poses, clouds, out, d_max, counts, here);
    if (remembers_) make_room(clouds);
    if constexpr (scan::tangent_hierarchy<hierarchy_type>)
      if (by_tangents.value_or(d_max == infinity && worth_tangents(clouds)))
        return pass<scan::packets_by::tangents>(poses, clouds, out, d_max, counts, here);
    return pass<scan::packets_by::bounds>(poses, clouds, out, d_max, counts, here);
  }

  /// Drops what is known of the last frame. The next one starts cold; its answer is the same.
  void forget() {
    const device_guard guard(on_.id);
    if (last_.size() != 0)
      check_cuda(cudaMemsetAsync(last_.data(), 0xff, last_.size() * sizeof(remembered<hierarchy_type>), on_.stream),
                 "cudaMemsetAsync");
  }

  /// How packets walk, for tests and benchmarks; else the faster way is chosen. The answer is the same.
  std::optional<bool> by_tangents;

 private:
  using hierarchy_type = typename PartView::hierarchy_type;

  /// A walk by tangents takes fewer steps, but a few packets take long, and with few points a frame waits for those.
  /// Tiles of an image are compact, so that they gain with any number. (Measured: docs/distances.md.)
  template <class Clouds>
  static bool worth_tangents(const Clouds& clouds) {
    bool worth = true;
    for_each_cloud(clouds, [&](const auto& source, const Eigen::Isometry3d&) {
      worth = worth && (source.size() >= 1u << 20 || scan::by_packets::columns_of(source) != 0);
    });
    return worth;
  }

  template <scan::packets_by How, class Clouds, class Here>
  distance_certainty pass(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const distances_out& out,
                          real d_max, point_counts* counts, const Here& here) {
    constexpr bool by_cells = How == scan::packets_by::cells;
    using tally = points_of<std::conditional_t<by_cells, celled_view<PartView>, PartView>, How>;
    return certainty_of(launch_.pass(
        facts_, poses, clouds,
        [&](const auto& source, std::uint32_t group, const frames::turn& now) {
          // Many points do not wait for their first primitives.
          const bool look_up = !by_cells && d_max == infinity && source.size() < 1u << 20;
          return launch_.template begin<tally>(group, now,
                                               {out, d_max, group * scan::most_parts, group == 0 ? counts : nullptr,
                                                last_.data(), look_up ? launch_.fields(group) : nullptr});
        },
        here));
  }

  template <class Clouds>
  void make_room(const Clouds& clouds) {
    std::size_t points = 0;
    for_each_cloud(clouds, [&](const auto& source, const Eigen::Isometry3d&) { points += source.size(); });
    if (points <= last_.size()) return;
    device_buffer<remembered<hierarchy_type>> larger(points, on_.id, memory_);
    outgrown_.push_back(std::exchange(last_, std::move(larger)));  // a graph may have captured it
    forget();
  }

  device on_;
  std::pmr::memory_resource* memory_;
  bool remembers_;
  std::vector<part_facts> facts_;
  scan::launcher<PartView> launch_;
  device_buffer<remembered<hierarchy_type>> last_;
  std::vector<device_buffer<remembered<hierarchy_type>>> outgrown_;
};

/// On a device: the kernel of packets, which remembers the primitive nearest to each point.
template <>
struct points_on<device> {
  template <class PartView>
  struct kept : device_points<PartView> {
    kept(const device& on, const model_view<PartView>& model, std::pmr::memory_resource* memory = nullptr)
        : device_points<PartView>(on, model, memory, true) {}
  };
};

}  // namespace clearance::pointwise
