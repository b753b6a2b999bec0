// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The parts of a frame in a block's shared memory.

#include <clearance/ground/read_only.hpp>
#include <clearance/scan/block.cuh>

namespace clearance::scan {

/// A part's place and tree.
template <class Tally>
struct frame_parts {
  using memory = typename Tally::block;
  using view_type = typename Tally::part_type;
  using part_type = block_part<view_type>;

  static __device__ memory& here() { return memory_of_block<Tally>(); }
  static __device__ part_type* parts() {
    extern __shared__ __align__(16) std::byte scan_memory[];
    return reinterpret_cast<part_type*>(scan_memory + sizeof(memory));
  }
  static __device__ const frame_part& place(std::uint32_t k) { return parts()[k].place; }
  static __device__ const view_type& view(std::uint32_t k) { return parts()[k].view; }

  /// Copies them there. Every thread copies a share, and calls `meanwhile` once while it waits for its first words.
  template <class F>
  static __device__ void prepare(const scan_arguments<Tally>& a, F meanwhile) {
    memory& s = here();
    const std::uint32_t t = threadIdx.x;
    // Dealt evenly to all warps, because threads of a warp read kernel arguments one after another.
    const std::uint32_t dealt = (t & 31) * warps + t / 32;
    if (a.far)
      copy_parts(a.rest->parts.part, a.views, a.parts, t, meanwhile);
    else
      copy_parts(a.near.part, a.views, a.parts, dealt, meanwhile);
    constexpr std::uint32_t head_words = sizeof(s.head) / sizeof(uint4),
                            ball_words = sizeof(frames::root_ball) / sizeof(uint2);
    static_assert(sizeof(s.head) % sizeof(uint4) == 0 && sizeof(frames::root_ball) % sizeof(uint2) == 0);
    if (const std::uint32_t last = block_threads - 1 - t; last < head_words)
      reinterpret_cast<uint4*>(&s.head)[last] =
          reinterpret_cast<const uint4*>(static_cast<const scan_head<Tally>*>(&a))[last];
    if (const std::uint32_t i = t - 128; i < (a.parts + cluster - 1) / cluster * ball_words)
      reinterpret_cast<uint2*>(s.cluster)[i] = reinterpret_cast<const uint2*>(a.clusters())[i];
    if (t < drop_reasons) s.dropped[t] = 0;
    s.answer.clear(t);
    if (t == block_threads - 64) {
      s.origin = a.facts().origin;
      s.shifted = s.origin.x != 0 || s.origin.y != 0 || s.origin.z != 0;
      s.rigid = !a.placed || a.rest->rigid;
      s.clear();
    }
  }

 private:
  /// Every thread reads first and then writes, so that it waits once.
  template <class F>
  static __device__ void copy_parts(const frame_part* places, const view_type* views, std::uint32_t count,
                                    std::uint32_t thread, F meanwhile) {
    using word = std::conditional_t<sizeof(view_type) % sizeof(uint4) == 0, uint4, std::uint32_t>;
    constexpr std::uint32_t place_words = sizeof(frame_part) / sizeof(uint4),
                            view_words = sizeof(view_type) / sizeof(word);
    static_assert(sizeof(frame_part) % sizeof(uint4) == 0 && sizeof(view_type) % sizeof(word) == 0);
    const std::uint32_t words = count * (place_words > view_words ? place_words : view_words);
    std::uint32_t i = thread;
#pragma unroll 1
    do {
      const bool of_place = i < count * place_words, of_view = i < count * view_words;
      uint4 place;
      word view;
      if (of_place) place = reinterpret_cast<const uint4*>(places)[i];
      if (of_view) view = reinterpret_cast<const word*>(views)[i];
      if (i == thread) meanwhile();
      if (of_place) reinterpret_cast<uint4*>(&parts()[i / place_words].place)[i % place_words] = place;
      if (of_view) reinterpret_cast<word*>(&parts()[i / view_words].view)[i % view_words] = view;
      i += block_threads;
    } while (i < words);
  }
};

}  // namespace clearance::scan
