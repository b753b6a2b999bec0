// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Labels of all points, as the blocks of a device write and count them.

#include <clearance/concepts.hpp>
#include <clearance/points/masked.hpp>
#include <clearance/scan/reader.cuh>

namespace clearance::pairwise {

/// An answer that also meets every point: it has labels, one byte each, and counts those that are `own` and
/// `uncertain`.
template <class A>
concept labelling_answer = answer<A> && requires(const A a, const pair_distance pair, std::uint32_t n) {
  *a.label_of(n, n) = a.whose_alone(true);
  a.is_late(pair), a.counts->own, a.counts->uncertain;
};

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
    for (std::uint32_t b = threadIdx.x; b < gridDim.x; b += 32)
      all.own += a.answer.labelled[b].own, all.uncertain += a.answer.labelled[b].uncertain;
    all = {scan::sum_of(all.own), scan::sum_of(all.uncertain)};
    auto& counts = *a.answer.answer.counts;
    if (threadIdx.x == 0)
      counts.own = (a.cloud == 0 ? 0 : counts.own) + all.own,
      counts.uncertain = (a.cloud == 0 ? 0 : counts.uncertain) + all.uncertain;
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
    own = scan::sum_of(own), uncertain = scan::sum_of(uncertain);
    if (threadIdx.x % 32 == 0 && own != 0) atomicAdd(&s.answer.own, own);
    if (threadIdx.x % 32 == 0 && uncertain != 0) atomicAdd(&s.answer.uncertain, uncertain);
    __syncthreads();
  }
};

}  // namespace clearance::pairwise
