// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Gives every pair to an answer once, by the blocks of a device. The answer may also label every point.

#include <clearance/backends/device.cuh>
#include <clearance/backends/readback.cuh>
#include <clearance/concepts.hpp>
#include <clearance/frames/readable.cuh>
#include <clearance/pairwise/each_pair.hpp>
#include <clearance/pairwise/pairs_on.hpp>
#include <clearance/points/masked.hpp>
#include <clearance/scan/arguments.hpp>
#include <clearance/scan/kernel.cuh>
#include <clearance/scan/launch.cuh>
#include <clearance/scan/reader.cuh>

namespace clearance::pairwise {

// Labels of all points, as the blocks of a device write and count them.

/// A block's counts of its labels.
struct alignas(8) label_counts {
  std::uint32_t own, uncertain;
};

/// The labels of a scan whose answer is `Pairs`.
template <class Pairs>
struct labels_of {
  using arguments = scan::scan_arguments<Pairs>;

  /// Labels four of a thread's points before their pairs come. `reasons`: why points do not count, one byte each.
  static __device__ void meet(const typename Pairs::block& s, unsigned reasons, std::uint32_t first) {
    if (s.head.answer.first_part != 0) return;  // another kernel has labelled them
    const auto& answer = s.head.answer.answer;
    auto* const label = answer.label_of(s.head.cloud, first);
    const auto alone = answer.whose_alone(true), no_point = answer.whose_alone(false);
    if (is_aligned(label) && (reasons & 0x80808080u) == 0) {
      static_assert(sizeof *label == 1 && drop_reasons < 0x80);
      const unsigned dropped = __vcmpne4(reasons, 0);
      *reinterpret_cast<std::uint32_t*>(label) =
          (dropped & std::uint32_t(no_point) * 0x01010101u) | (~dropped & std::uint32_t(alone) * 0x01010101u);
    } else {
#pragma unroll
      for (int j = 0; j < scan::quad; ++j)
        if (const unsigned reason = reasons >> 8 * j & 0xff; reason != scan::no_point)
          label[j] = reason == 0 ? alone : no_point;
    }
  }

  /// Hands in this block's counts, in the kernel of the last group of parts.
  static __device__ void hand_in(const arguments& a) {
    if (!a.answer.last_group) return;
    count(a);
    if (const auto& s = scan::memory_of_block<Pairs>().answer; threadIdx.x == 0)
      a.answer.labelled[blockIdx.x] = {s.own, s.uncertain};
  }
  /// Called by the last block: adds all blocks' counts to the answer's.
  static __device__ void conclude(const arguments& a) {
    if (!a.answer.last_group || threadIdx.x >= 32) return;
    label_counts all{0, 0};
    for (std::uint32_t b = threadIdx.x; b < gridDim.x; b += 32) {
      all.own += a.answer.labelled[b].own;
      all.uncertain += a.answer.labelled[b].uncertain;
    }
    all = {scan::sum_of(all.own), scan::sum_of(all.uncertain)};
    auto& counts = *a.answer.answer.counts;
    if (threadIdx.x == 0) {
      counts.own = (a.cloud == 0 ? 0 : counts.own) + all.own;
      counts.uncertain = (a.cloud == 0 ? 0 : counts.uncertain) + all.uncertain;
    }
  }

 private:
  static __device__ bool is_aligned(const point_label* label) {
    return reinterpret_cast<std::uintptr_t>(label) % scan::quad == 0;
  }

  /// Adds the labels of this block's points to its own counts.
  static __device__ void count(const arguments& a) {
    auto& s = scan::memory_of_block<Pairs>();
    const scan::cards<Pairs> all(a.rounds);
    std::uint32_t own = 0, uncertain = 0;
    __syncthreads();  // all labels have been written
    for (std::uint32_t r = 0; r < a.rounds; ++r) {
      const std::uint32_t first = all.index(r);
      const point_label* const label = first < a.points ? s.head.answer.answer.label_of(a.cloud, first) : nullptr;
      std::uint32_t four = 0;  // labels; a label of 0 does not count here
      static_assert(point_label::rest == point_label{});
      if (label != nullptr && a.points - first >= scan::quad && is_aligned(label))
        four = *reinterpret_cast<const std::uint32_t*>(label);
      else if (label != nullptr)
        for (std::uint32_t j = 0; j < scan::quad && j < a.points - first; ++j) four |= std::uint32_t(label[j]) << 8 * j;
      own += __popc(__vcmpeq4(four, std::uint32_t(point_label::own) * 0x01010101u)) / 8;
      uncertain += __popc(__vcmpeq4(four, std::uint32_t(point_label::uncertain) * 0x01010101u)) / 8;
    }
    own = scan::sum_of(own);
    uncertain = scan::sum_of(uncertain);
    if (threadIdx.x % 32 == 0 && own != 0) atomicAdd(&s.answer.own, own);
    if (threadIdx.x % 32 == 0 && uncertain != 0) atomicAdd(&s.answer.uncertain, uncertain);
    __syncthreads();
  }
};

/// `Around` makes of a position what is measured.
template <class PartView, answer Answer, class Around = scan::as_points>
struct pairs_of {
  using part_type = PartView;
  using element = typename Around::element;
  using hierarchy_type = typename PartView::hierarchy_type;
  using primitive_type = typename hierarchy_type::primitive_type;
  using record = scan::record<typename scan::node_of<hierarchy_type>::place>;
  using scan_type = std::conditional_t<ending_answer<Answer>, scan::by_pairs, scan::by_many_pairs>;
  using block = scan::pair_memory<pairs_of>;
  static constexpr bool bound_per_part = true;
  /// So few pairs walk at once without going down to a leaf first. Few pairs of an answer that ends are that near.
  static constexpr std::uint32_t few = ending_answer<Answer> ? 8 * scan::warps : 0;
  /// The same of those that fields have left: if labels settle most pairs, few are left.
  static constexpr std::uint32_t few_left = settling_answer<Answer> && few == 0 ? 4 * scan::warps : few;
  static constexpr bool points = std::is_same_v<element, vec3>;
  static constexpr bool coarse = coarse_answer<Answer>, labels = labelling_answer<Answer>, goes_ahead = points;
  /// Leaves room for two blocks on a processor of an H200 and, up to 20 parts, for the cache that reading points ahead
  /// needs there.
  static constexpr std::size_t top_bytes = 6400;

  struct arguments {
    Answer answer;
    std::uint32_t first_part;  ///< Number of the kernel's first part.
    const field_view* fields;  ///< One for each of its parts, or null.
    point_counts* counts;      ///< Or null.
    label_counts* labelled;    ///< Room for one per block, if there are labels.
    bool last_group;           ///< Of parts.
    Around around;
  };
  struct memory {
    distance_key best[scan::pair_capacity];  ///< Distance and primitive of each pair that is being looked at.
    std::uint32_t
        least[coarse ? scan::most_parts : 1];  ///< Per part, `ordered`: the least distance that this block knows.
    std::uint32_t own, uncertain;              ///< Labels.
    std::uint32_t open_count;                  ///< How many pairs are not known yet,
    std::uint16_t open[scan::pair_capacity];   ///< and which.

    __device__ void clear(std::uint32_t thread) {
      if (thread == 0) own = uncertain = open_count = 0;
      if (coarse && thread < scan::most_parts) least[thread] = scan::no_bound;
      for (std::uint32_t i = thread; i < scan::pair_capacity; i += scan::block_threads) best[i] = no_key;
    }
  };

  static constexpr __device__ bool bounds_differ(const block&) { return true; }
  static __device__ real reach_of_part(const block& s, std::uint32_t part, std::uint32_t) {
    return s.head.answer.answer.reach(s.head.answer.first_part + part);
  }
  static __device__ real reach_of_pair(const block& s, std::uint32_t part, std::uint32_t pair) {
    const distance_key best = scan::fresh(s.answer.best[pair]);
    if constexpr (coarse) {
      if (best == no_key) return reach_of_part(s, part, 0);
      return s.head.answer.answer.reach(s.head.answer.first_part + part, key_distance(best),
                                        from_ordered(scan::fresh(s.answer.least[part])));
    } else {
      return min(reach_of_part(s, part, 0), key_distance(best));
    }
  }
  static __device__ std::uint32_t common_bound(const block&) { return 0; }
  static __device__ const field_view* fields(const block& s) { return s.head.answer.fields; }

  static __device__ bool settled(const block&, std::uint32_t, std::uint32_t) { return false; }
  static __device__ bool touched(const block&, std::uint32_t, std::uint32_t) { return false; }
  /// True if nothing more of the part matters to the pair. `x` is its point in the cloud's frame. Inside a solid the
  /// distance is 0.
  static __device__ bool skips(const block& s, std::uint32_t part, std::uint32_t point, std::uint32_t pair, vec3 x) {
    if constexpr (settling_answer<Answer>)
      if (s.head.answer.answer.settled(s.head.cloud, point - s.head.first, s.head.answer.first_part + part))
        return true;
    if (!coarse || !points || scan::fresh(s.answer.best[pair]) == no_key) return false;
    const real reach = reach_of_pair(s, part, pair);
    return !frames::may_reach(scan::frame_parts<pairs_of>::place(part).root.around,
                              scan::has_interior<PartView> ? max(reach, 0) : reach, x);
  }
  /// The caller has the pair for itself. A primitive that was reached ahead may also be at distance 0; it is not
  /// reported then.
  static __device__ void take_inside(block& s, std::uint32_t part, std::uint32_t, std::uint32_t pair) {
    if (!(reach_of_part(s, part, 0) >= 0)) return;
    s.answer.best[pair] = make_key(0, none);
    hear(s, part, pair, make_key(0, none));
  }
  static __device__ bool wants_certain(const block&) { return false; }
  static __device__ void take_certain(block&) {}
  static __device__ void take(block& s, const record& r, const primitive_type&, std::uint32_t pair) {
    if (r.key != no_key) hear(s, r.part, pair, make_key(key_distance(r.key), r.id));
  }
  /// Takes a primitive of a pair.
  static __device__ void hear(block& s, std::uint32_t part, std::uint32_t pair, distance_key found) {
    atomicMin(&s.answer.best[pair], found);
    if constexpr (coarse)
      if (const std::uint32_t distance = ordered(key_distance(found)); distance < scan::fresh(s.answer.least[part]))
        atomicMin(&s.answer.least[part], distance);
  }
  /// Takes an upper bound on a pair's distance. Only a coarse answer can do with that.
  static __device__ void hear_bound(block& s, std::uint32_t part, std::uint32_t pair, real high) {
    if (coarse && high <= reach_of_part(s, part, 0)) hear(s, part, pair, make_key(high, none));
  }
  static __device__ void leave_open(block& s, std::uint32_t pair) {
    s.answer.open[atomicAdd(&s.answer.open_count, 1u)] = std::uint16_t(pair);
  }
  static __device__ void close_all(block& s) { s.answer.open_count = 0; }
  static __device__ std::uint32_t open_pairs(const block& s) { return s.answer.open_count; }
  static __device__ std::uint32_t open_pair(const block& s, std::uint32_t i) { return s.answer.open[i]; }
  /// Called by all threads when the block has nothing left to walk.
  static __device__ void drained(block& s, std::uint32_t count) {
    if (threadIdx.x == 0) s.answer.open_count = 0;
    if constexpr (labels) {
      take_all(s, count, [&s](const pair_distance& pair) { return !s.head.answer.answer.is_late(pair); });
      __syncthreads();
    }
    take_all(s, count, [](const pair_distance&) { return true; });
  }

  static __device__ void meet([[maybe_unused]] const block& s, [[maybe_unused]] unsigned reasons,
                              [[maybe_unused]] std::uint32_t first) {
    if constexpr (labels) labels_of<pairs_of>::meet(s, reasons, first);
  }

  struct news {
    explicit __device__ news(const block&) {}
    __device__ void hear(block&) {}
  };
  struct seeds {
    explicit __device__ seeds(const scan::scan_arguments<pairs_of>&) {}
    template <class Source>
    __device__ void seed_from(const scan::scan_arguments<pairs_of>&, const Source&) {}
    __device__ void seed(const scan::scan_arguments<pairs_of>&) const {}
    static __device__ std::uint32_t found(std::uint32_t) { return 0; }
  };
  static __device__ void seed_cold(const scan::quad_points&) {}

  template <class Source>
  static __device__ void hand_in(const scan::scan_arguments<pairs_of>& a, const Source&) {
    if constexpr (labels) labels_of<pairs_of>::hand_in(a);
  }
  template <class Source>
  static __device__ void conclude(const scan::scan_arguments<pairs_of>& a, const Source&) {
    scan::write_counts(a, a.answer.counts);
    if constexpr (labels) labels_of<pairs_of>::conclude(a);
  }
  static __device__ void reset(const scan::scan_arguments<pairs_of>&) {}

 private:
  /// Gives the answer the pairs that `now` chooses.
  template <class Now>
  static __device__ void take_all(block& s, std::uint32_t count, const Now& now) {
    for (std::uint32_t i = threadIdx.x; i < count; i += scan::block_threads) {
      const distance_key best = s.answer.best[i];
      if (best == no_key) continue;
      const pair_distance pair{s.head.cloud, s.pair_table[i].point - s.head.first,
                               s.head.answer.first_part + s.part_of_pair[i], key_index(best), key_distance(best)};
      if (!now(pair)) continue;
      s.answer.best[i] = no_key;
      s.head.answer.answer.take(pair);
    }
  }
};

/// Is a kernel that looks into cells made for such answers? One that ends, or labels, walks few pairs, and was no
/// quicker by it (bench/records/h100/with_cells.txt).
template <answer Answer>
inline constexpr bool gains_by_cells = !ending_answer<Answer> && !labelling_answer<Answer>;

/// Every pair on a device, frame after frame, with one kernel per cloud. It allocates nothing and never waits.
template <class PartView>
class device_pairs {
 public:
  device_pairs(const device& on, const model_view<PartView>& model, std::pmr::memory_resource* memory = nullptr)
      : facts_(model.facts.begin(), model.facts.end()),
        launch_(on, model, memory),
        labelled_(launch_.most_blocks(), on.id, memory) {}

  /// `counts` lies in memory that the device can write. `here(source, cloud)` returns a source that the device can
  /// read.
  template <class Clouds, answer Answer, class Here>
  void enqueue(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const Answer& answer,
               point_counts* counts, const Here& here) {
    if constexpr (cored_hierarchy<typename PartView::hierarchy_type> && gains_by_cells<Answer>)
      if (launch_.has_cells()) return pass<celled_view<PartView>>(poses, clouds, answer, counts, here);
    pass<PartView>(poses, clouds, answer, counts, here);
  }

 private:
  /// `View`: as the kernels see parts. Those of capsules look into no cells.
  template <class View, class Clouds, class Answer, class Here>
  void pass(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const Answer& answer, point_counts* counts,
            const Here& here) {
    launch_.pass(
        facts_, poses, clouds,
        [&]<point_source S>(const S& source, std::uint32_t group, const frames::turn& now) {
          if constexpr (labelling_answer<Answer>) static_assert(points_alone<S>());
          const auto around = scan::elements_of(source);
          using around_type = std::remove_const_t<decltype(around)>;
          using view = std::conditional_t<std::is_same_v<around_type, scan::as_points>, View, PartView>;
          return launch_.template begin<pairs_of<view, Answer, around_type>>(
              group, now,
              {answer, group * scan::most_parts, launch_.fields(group), group == 0 ? counts : nullptr, labelled_.data(),
               group + 1 == launch_.groups(), around});
        },
        here);
  }

  std::vector<part_facts> facts_;
  scan::launcher<PartView> launch_;
  device_buffer<label_counts> labelled_;
};

/// On a device: the kernel of a scan.
template <>
struct pairs_on<device> {
  static constexpr bool meets_points = true;
  template <class PartView>
  using kept = device_pairs<PartView>;
};

}  // namespace clearance::pairwise
