// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The least distance as the blocks of a device find it. All parts share a bound, or each has its own.

#include <clearance/minimum/evidence.cuh>
#include <clearance/minimum/seeds.cuh>
#include <clearance/scan/kernel.cuh>

namespace clearance::minimum {

// The end of a frame if all parts share a bound. While a block is counted, three of its warps draft the answer from its
// own best. It is used if the block is the last one and has the best of all, as the slowest often does.

/// Drafts the answer from `best`, by three warps: where the point is, what is nearest to it, and the bracket.
template <class Tally, class Source>
__forceinline__ __device__ void draft_answer(const scan::scan_arguments<Tally>& a, const Source& source) {
  auto& block = scan::memory_of_block<Tally>();
  auto& s = block.answer;
  if (threadIdx.x % 32 != 0) return;
  evidence<Tally> e;
  if (threadIdx.x / 32 != 3) e = {a, source, typename Tally::witness_type{s.best[0], s.nearest}};
  switch (threadIdx.x / 32) {
    case 1:
      s.answer.at = e.at(a);
      break;
    case 2: {
      const bool inside = e.complete();
      const contact here = e.touching(a, inside);
      s.answer.nearest = here.nearest;
      s.answer.normal = here.normal;
      s.answer.primitive = e.r.id;
      break;
    }
    case 3: {
      const min_distance_result r = bracket_of(a, s.best[0], false, certain_of(a, s.best[0]));
      s.answer.state = r.state;
      s.answer.part = r.part;
      s.answer.distance = r.distance;
      s.answer.lower = r.lower;
      s.answer.upper = r.upper;
      break;
    }
  }
}

template <class Tally>
struct one_minimum {
  /// Hands the block's best to the last block. Done by the first four warps.
  template <class Source>
  static __device__ void hand_in(const scan::scan_arguments<Tally>& a, const Source& source) {
    auto& block = scan::memory_of_block<Tally>();
    auto& s = block.answer;
    const std::uint32_t t = threadIdx.x;
    if (t >= 128) return;
    const bool known =
        s.best[0].key != no_key && s.best[0].id != none && block.rigid;  // more than a point inside a solid
    if (t == 0) {
      const auto best = s.best[0];
      s.drafted = known ? best.key : no_key;
      a.answer.candidates[blockIdx.x] = {best, s.nearest};
      if (best.key != no_key) atomicMin(&a.answer.state->best_key, best.key);
    } else if (t >= 32 && known) {
      draft_answer(a, source);
    }
    __syncwarp();
  }

  /// Called by the last block: writes the answer, and what is kept for the next frame.
  template <class Source>
  static __device__ void answer(const scan::scan_arguments<Tally>& a, const Source& source) {
    auto& block = scan::memory_of_block<Tally>();
    auto& s = block.answer;
    auto& state = *a.answer.state;
    const std::uint32_t t = threadIdx.x, blocks = gridDim.x;
    const distance_key key = block.rigid ? scan::fresh(state.best_key) : no_key;
    typename Tally::witness_type mine;
    if (t < blocks) mine = a.answer.candidates[t];
    for (std::uint32_t b = t + scan::block_threads; b < blocks; b += scan::block_threads)
      if (const auto c = a.answer.candidates[b]; before(c.r, mine.r)) mine = c;
    const bool here = key != no_key && key_index(key) >= a.first, won = here && mine.r.key == key;
    if (here && s.drafted != key) {
      if (won) {
        s.best[0] = mine.r;
        s.nearest = mine.primitive;
      }
      __syncthreads();
      if (t >= 32 && t < 128) draft_answer(a, source);
    }
    if (here) {
      min_distance_result& out = *a.answer.result;
      if (t == 32) {
        out.at = s.answer.at;
        out.cloud = a.cloud;
        out.point = key_index(key) - a.first;
      }
      if (t == 64) {
        out.nearest = s.answer.nearest;
        out.normal = s.answer.normal;
        out.primitive = s.answer.primitive;
      }
      if (t == 96) out.part = s.answer.part;
    }
    const bool parts_decide = Tally::bounds_differ(block);
    double lower = 0;
    if (parts_decide && t / 32 == 3 && a.last) lower = certain_of_parts(a);
    if (t == 96 && a.last) {
      const counted all(a);
      min_distance_result r;
      if (here) {
        r.state = s.answer.state;
        r.part = s.answer.part;
        r.distance = s.answer.distance;
        r.lower = s.answer.lower;
        r.upper = s.answer.upper;
      } else if (key != no_key)
        r = bracket_of(a, state.best[0], false, certain_of(a, state.best[0]));
      if (parts_decide && r.part != none) r = bracket_of(a, {make_key(r.distance, 0), r.part}, all.certain, lower);
      if (all.certain && r.part != none) {
        r.state = clearance::state::collision;
        r.lower = r.upper = 0;
      }
      write_bracket(a, r, all);
    }
    if (won) state.best[0] = mine.r;
    if (mine.r.key != no_key)
      if (const std::uint32_t place = won ? 0 : atomicAdd(&s.kept, 1u) + 1; place < 32)
        a.answer.witnesses[place] = mine;
    if (t == 0 && key == no_key) a.answer.witnesses[0].r = {};
  }
};

// The end of a frame if every part has a bound and a minimum.

template <class Tally>
struct part_minima {
  using record = typename Tally::record;

  template <class Source>
  static __device__ void hand_in(const scan::scan_arguments<Tally>& a, const Source&) {
    auto& s = scan::memory_of_block<Tally>().answer;
    if (const std::uint32_t t = threadIdx.x; t < a.parts) a.answer.records[t * gridDim.x + blockIdx.x] = s.best[t];
    __syncthreads();
  }

  /// Called by the last block. Independent steps have a thread each.
  template <class Source>
  static __device__ void answer(const scan::scan_arguments<Tally>& a, const Source& source) {
    auto& s = scan::memory_of_block<Tally>().answer;
    auto& state = *a.answer.state;
    const std::uint32_t t = threadIdx.x;
    const bool concludes = t == scan::block_threads - 32 && a.last;
    counted all;
    if (concludes) all = counted(a);
    record best;
    evidence_type mine = merge(a, source, best);
    if (!rigid()) best = {};
    const bool mine_here = mine.r.key != no_key && key_index(mine.r.key) >= a.first;
    if (mine_here && same(mine.r, best)) evidence_type(mine).write(a);
    if (concludes) write_bracket(a, bracket_of(a, best, all.certain, certain_of_each(a)), all);
    // Kept for the next frame: every part's minimum.
    if (const std::uint32_t slot = t / 32 + scan::warps * (t & 31); slot < a.parts) {
      state.best[slot] = s.best[slot];
      if (mine_here) {
        a.answer.witnesses[slot] = {mine.r, mine.primitive};
        mine.complete();
        a.answer.minima[slot] = {key_distance(mine.r.key), a.cloud, key_index(mine.r.key) - a.first, mine.r.id};
      } else if (mine.r.key == no_key) {
        a.answer.witnesses[slot].r = {};
        a.answer.minima[slot] = {};
      }
    }
  }

 private:
  using evidence_type = evidence<Tally>;
  static __device__ bool rigid() { return scan::memory_of_block<Tally>().rigid; }

  /// Puts every part's best, over all blocks and earlier clouds, into s.best, and gives the best of all to all threads.
  /// Returns the evidence of this thread's part, if it has one (the first lanes of warp w have parts w, w + 16, ...).
  template <class Source>
  static __device__ evidence_type merge(const scan::scan_arguments<Tally>& a, const Source& source, record& best) {
    auto& s = scan::memory_of_block<Tally>().answer;
    const std::uint32_t t = threadIdx.x, lane = t & 31;
    record its;
    for (std::uint32_t slot = t / 32, k = 0; slot < a.parts; slot += scan::warps, ++k) {
      record least = a.first > 0 ? a.answer.state->best[slot] : record{};
#pragma unroll 4
      for (std::uint32_t b = lane; b < gridDim.x; b += 32)
        if (const record r = a.answer.records[slot * gridDim.x + b]; before(r, least)) least = r;
      least = least_of_warp(least);
      if (lane == k) {
        its = least;
        s.best[slot] = least;
      }
    }
    const evidence_type mine(a, source, rigid() ? its : record{});
    __syncthreads();
    record least;
    for (std::uint32_t k = lane; k < a.parts; k += 32)
      if (before(s.best[k], least)) least = s.best[k];
    best = least_of_warp(least);
    return mine;
  }
};

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
  static constexpr std::uint32_t bounds = PerPart ? scan::most_parts : 1 + scan::most_parts;
  /// 73 nodes (three levels) of each of eight sphere trees. It leaves room for two blocks on a processor of an H200.
  static constexpr std::size_t top_bytes = PerPart ? 10000 : 14016;

  struct arguments {
    state_type* state;
    witness_type* witnesses;
    record* records;           ///< Room for one per part and block, if each part has a bound;
    witness_type* candidates;  ///< else room for one per block.
    min_distance_result* result;
    part_minimum* minima;      ///< One per part, or null.
    const real* extra;         ///< `extra_reaches`, one per part; null if the nearest pair decides, or with `minima`.
    const field_view* fields;  ///< One per part, or null: for a first bound.
    Around around;
  };

  struct memory {
    /// ordered(): the least that this block knows, and at times the least of all blocks. If parts share the first, and
    /// have `extra`, the others are their own: no more than may decide what is certain.
    std::uint32_t bound[bounds];
    std::uint32_t seed_of_warp[scan::warps];
    record best[slots];
    primitive_type nearest;     ///< The primitive of `best`, if all parts share a bound.
    distance_key least[slots];  ///< The keys of `best`, or those it is about to get.
    std::uint32_t kept;         ///< Witnesses for the next frame.
    unsigned lock[slots];
    distance_key drafted;  ///< The key that `answer` was drafted for.
    draft answer;

    __device__ void clear(std::uint32_t thread) {
      if (thread < slots) {
        best[thread] = {};
        least[thread] = no_key;
        lock[thread] = 0;
      }
      if (!PerPart && thread < scan::most_parts) bound[1 + thread] = no_bound;
      if (thread == scan::block_threads - 64) kept = 0;
    }
  };

  static __device__ std::uint32_t slot(std::uint32_t part) { return PerPart ? part : 0; }
  static __device__ bool bounds_differ(const block& s) { return PerPart || s.head.answer.extra != nullptr; }
  static __device__ real reach(const block& s, std::uint32_t part) {
    return from_ordered(scan::fresh(s.answer.bound[PerPart ? part : bounds_differ(s) ? 1 + part : 0]));
  }
  /// Lowers a part's own bound to what may decide beside the bound of all. The nearest pair itself stays below that, so
  /// that `lower` tells others of it.
  static __device__ real reach_of_part(block& s, std::uint32_t part, std::uint32_t bound) {
    if constexpr (PerPart) return reach(s, part);
    if (!bounds_differ(s)) return from_ordered(bound);
    const std::uint32_t most = ordered(frames::farther(from_ordered(bound), s.head.answer.extra[part])),
                        cut = most < no_bound ? most + 1 : most;
    return from_ordered(scan::lower_of(cut, atomicMin(&s.answer.bound[1 + part], cut)));
  }
  static __device__ real reach_of_pair(const block& s, std::uint32_t part, std::uint32_t) { return reach(s, part); }
  /// The bound of all parts, if they share one.
  static __device__ std::uint32_t common_bound(const block& s) { return scan::fresh(s.answer.bound[0]); }

  static __device__ void lower(block& s, std::uint32_t part, real distance) {
    const auto lower_here = [&](std::uint32_t i) {
      const std::uint32_t u = ordered(distance);
      if (u < atomicMin(&s.answer.bound[i], u)) atomicMin(&s.head.answer.state->bound[i], u);
    };
    if (!PerPart && bounds_differ(s)) lower_here(1 + part);
    lower_here(slot(part));
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
  static __device__ void meet(const block&, unsigned, std::uint32_t) {}
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
    explicit __device__ news(const block& s) : bounds_(bounds_differ(s) ? !PerPart + s.head.parts : 1) { ask(s); }
    __device__ void hear(block& s) {
      if (threadIdx.x >= bounds_) return;
      if (elsewhere_ < scan::fresh(s.answer.bound[threadIdx.x])) atomicMin(&s.answer.bound[threadIdx.x], elsewhere_);
      if (!PerPart && threadIdx.x != 0) reach_of_part(s, threadIdx.x - 1, common_bound(s));
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
    if (a.last && threadIdx.x < slots) a.answer.state->bound[threadIdx.x] = no_bound;
  }
  /// Called by one thread, after `conclude`.
  static __device__ void reset(const scan::scan_arguments<least>& a) {
    state_type& state = *a.answer.state;
    const std::uint32_t kept = scan::memory_of_block<least>().answer.kept;
    state.seeded = 0;
    state.witnesses = PerPart ? a.parts : (kept < 31 ? kept + 1 : 32);
    if (a.last) {
      state.certain = 0;
      state.best_key = no_key;
    }
  }
};

}  // namespace clearance::minimum
