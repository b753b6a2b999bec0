// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The least distance as the blocks of a device find it. All parts share a bound, or each has its own.

#include <clearance/minimum/best.cuh>
#include <clearance/minimum/one_minimum.cuh>
#include <clearance/minimum/part_minima.cuh>
#include <clearance/minimum/seeds.cuh>
#include <clearance/scan/kernel.cuh>

namespace clearance::minimum {

/// `PerPart`: one bound per part, and every part's minimum. Otherwise one bound for all, the paper's Algorithm 3.
/// `Around` makes of a position what is measured.
template <class PartView, bool PerPart, class Around = scan::as_points>
struct least {
  using part_type = PartView;
  using element = typename Around::element;
  using hierarchy_type = typename PartView::hierarchy_type;
  using primitive_type = typename hierarchy_type::primitive_type;
  using record = minimum::record<typename scan::node_of<hierarchy_type>::place>;
  using witness_type = witness<record, primitive_type>;
  using state_type = device_state<record>;
  using scan_type = scan::by_pairs;
  using block = scan::pair_memory<least>;
  using seeds = last_frame<least>;
  static constexpr bool bound_per_part = PerPart, goes_ahead = false;
  static constexpr std::uint32_t slots = PerPart ? scan::most_parts : 1;
  /// 73 nodes (three levels) of each of eight sphere trees. It leaves room for two blocks on a processor of an H200.
  static constexpr std::size_t top_bytes = PerPart ? 10000 : 14016;

  struct arguments {
    state_type* state;
    witness_type* witnesses;
    record* records;           ///< Room for one per part and block, if each part has a bound;
    witness_type* candidates;  ///< else room for one per block.
    min_distance_result* result;
    part_minimum* minima;      ///< One per part, or null.
    const field_view* fields;  ///< One per part, or null: for a first bound.
    Around around;
  };

  struct memory {
    std::uint32_t bound[slots];  ///< ordered(): the least that this block knows, and at times the least of all blocks.
    std::uint32_t seed_of_warp[scan::warps];
    record best[slots];
    primitive_type nearest;     ///< The primitive of `best`, if all parts share a bound.
    distance_key least[slots];  ///< The keys of `best`, or those it is about to get.
    std::uint32_t kept;         ///< Witnesses for the next frame.
    unsigned lock[slots];
    distance_key drafted;  ///< The key that `answer` was drafted for.
    draft answer;

    __device__ void clear(std::uint32_t thread) {
      if (thread < slots) best[thread] = {}, least[thread] = no_key, lock[thread] = 0;
      if (thread == scan::block_threads - 64) kept = 0;
    }
  };

  static __device__ std::uint32_t slot(std::uint32_t part) { return PerPart ? part : 0; }
  static __device__ real reach(const block& s, std::uint32_t part) {
    return from_ordered(scan::fresh(s.answer.bound[slot(part)]));
  }
  static __device__ real reach_of_part(const block& s, std::uint32_t part, std::uint32_t bound) {
    return PerPart ? reach(s, part) : from_ordered(bound);
  }
  static __device__ real reach_of_pair(const block& s, std::uint32_t part, std::uint32_t) { return reach(s, part); }
  /// The bound of all parts, if they share one.
  static __device__ std::uint32_t common_bound(const block& s) { return scan::fresh(s.answer.bound[0]); }

  static __device__ void lower(block& s, std::uint32_t part, real distance) {
    const std::uint32_t u = ordered(distance);
    if (u < atomicMin(&s.answer.bound[slot(part)], u)) atomicMin(&s.head.answer.state->bound[slot(part)], u);
  }

  /// True if nothing is left to learn. It stays false for the point of the minimum itself: another part may have been
  /// first there, and the lowest part counts.
  static __device__ bool settled(const block& s, std::uint32_t part, std::uint32_t point) {
    return scan::fresh(s.answer.least[slot(part)]) < make_key(0, point) &&
           load_relaxed(&s.head.answer.state->certain) != 0;
  }
  /// Has a lower point distance 0? A part with an interior has no less.
  static __device__ bool touched(const block& s, std::uint32_t part, std::uint32_t point) {
    return scan::fresh(s.answer.least[slot(part)]) < make_key(0, point);
  }
  static constexpr __device__ bool skips(const block&, std::uint32_t, std::uint32_t, std::uint32_t, vec3) {
    return false;
  }
  static __device__ void take_inside(block& s, std::uint32_t part, std::uint32_t point, std::uint32_t) {
    lower(s, part, 0);
    atomicMin(&s.answer.least[slot(part)], make_key(0, point));
    keep_best<least>(s, {make_key(0, point), part}, s.answer.nearest);
  }
  static __device__ bool wants_certain(const block&) { return true; }
  static __device__ void take_certain(block& s) { atomicAdd(&s.head.answer.state->certain, 1ull); }

  /// Called by all lanes of a warp, each with a record or none.
  static __device__ void take(block& s, const record& r, const primitive_type& primitive, std::uint32_t) {
    best_of_warp<least>(s, r, primitive);
  }
  static __device__ void drained(block&, std::uint32_t) {}

  /// The bounds of other blocks. They are requested some rounds before they are read, so that nothing waits for memory.
  class news {
   public:
    explicit __device__ news(const block& s) : bounds_(PerPart ? s.head.parts : 1) { ask(s); }
    __device__ void hear(block& s) {
      if (threadIdx.x >= bounds_) return;
      if (elsewhere_ < scan::fresh(s.answer.bound[threadIdx.x])) atomicMin(&s.answer.bound[threadIdx.x], elsewhere_);
      ask(s);
    }

   private:
    __device__ void ask(const block& s) {
      if (threadIdx.x < bounds_) elsewhere_ = scan::fresh(s.head.answer.state->bound[threadIdx.x]);
    }
    std::uint32_t bounds_, elsewhere_ = no_bound;
  };

  static __device__ void seed_cold(scan::quad_points p) { minimum::seed_cold<least>(p); }

  using end = std::conditional_t<PerPart, part_minima<least>, one_minimum<least>>;
  template <class Source>
  static __device__ void hand_in(const scan::scan_arguments<least>& a, const Source& source) {
    end::hand_in(a, source);
  }
  /// Called by the last block.
  template <class Source>
  static __device__ void conclude(const scan::scan_arguments<least>& a, const Source& source) {
    end::answer(a, source);
    if (a.last && threadIdx.x < scan::most_parts) a.answer.state->bound[threadIdx.x] = no_bound;
  }
  /// Called by one thread, after `conclude`.
  static __device__ void reset(const scan::scan_arguments<least>& a) {
    state_type& state = *a.answer.state;
    const std::uint32_t kept = scan::memory_of_block<least>().answer.kept;
    state.seeded = 0;
    state.witnesses = PerPart ? a.parts : (kept < 31 ? kept + 1 : 32);
    if (a.last) state.certain = 0, state.best_key = no_key;
  }
};

}  // namespace clearance::minimum
