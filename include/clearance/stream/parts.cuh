// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The parts of a frame in a block's shared memory: places, trees, and each tree's first nodes.

#include <clearance/stream/block.cuh>

namespace clearance::stream {

/// What is far is read as what nobody writes; so compilers do not mix it up with what is in shared memory.
template <class T>
__device__ T far(const T* from) {
  using word = std::conditional_t<alignof(T) % 16 == 0, uint4, std::uint32_t>;
  if constexpr (sizeof(T) % sizeof(word) != 0 || alignof(T) < 4) {
    return *from;
  } else {
    union copy {
      __device__ copy() {}
      T value;
      word words[sizeof(T) / sizeof(word)];
    } c;
#pragma unroll
    for (std::size_t i = 0; i < sizeof(T) / sizeof(word); ++i) c.words[i] = __ldg(reinterpret_cast<const word*>(from) + i);
    return c.value;
  }
}

/// A part's place and tree.
template <class PartView, bool Each>
struct frame_parts {
  using memory = block_memory<PartView, Each>;
  using volume_type = typename memory::volume_type;
  using part_type = block_part<PartView>;

  static __device__ memory& here() { return memory_of_block<PartView, Each>(); }
  static __device__ part_type* parts() {
    extern __shared__ __align__(16) std::byte stream_memory[];
    return reinterpret_cast<part_type*>(stream_memory + sizeof(memory));
  }
  static __device__ const frame_part& place(std::uint32_t k) { return parts()[k].place; }
  static __device__ const PartView& view(std::uint32_t k) { return parts()[k].view; }
  /// Node n of part k, and its volume: from shared memory, if it is one of the first.
  static __device__ bvh_node node(std::uint32_t k, std::uint32_t n) {
    const std::uint32_t stride = here().head.top_stride;
    if (n < stride) return here().top_nodes[k * stride + n];
    return far(view(k).tree.nodes + n);
  }
  static __device__ volume_type volume(std::uint32_t k, std::uint32_t n) {
    const std::uint32_t stride = here().head.top_stride;
    if (n < stride) return here().top_volumes[k * stride + n];
    return far(view(k).tree.volumes + n);
  }

  /// Every thread brings a share of it; and calls `meanwhile` once, while it waits for the first.
  template <class F>
  static __device__ void prepare(const frame_args<PartView>& a, F meanwhile) {
    memory& s = here();
    const std::uint32_t t = threadIdx.x;
    // Dealt to all warps alike: threads of a warp read kernel arguments one after another.
    const std::uint32_t dealt = (t & 31) * warps + t / 32;
    if (a.far)
      copy_parts(a.rest->parts.part, a.views, a.parts, t, meanwhile);
    else
      copy_parts(a.near.part, a.views, a.parts, dealt, meanwhile);
    constexpr std::uint32_t head_words = sizeof(s.head) / sizeof(uint4), ball_words = sizeof(search::root_ball) / sizeof(uint2);
    static_assert(sizeof(s.head) % sizeof(uint4) == 0 && sizeof(search::root_ball) % sizeof(uint2) == 0);
    if (const std::uint32_t last = block_threads - 1 - t; last < head_words)
      reinterpret_cast<uint4*>(&s.head)[last] = reinterpret_cast<const uint4*>(static_cast<const frame_head<PartView>*>(&a))[last];
    if (const std::uint32_t i = t - 128; i < (a.parts + cluster - 1) / cluster * ball_words)
      reinterpret_cast<uint2*>(s.cluster)[i] = reinterpret_cast<const uint2*>(a.clusters())[i];
    if (t < drop_reasons) s.dropped[t] = 0;
    if (t < memory::slots) s.best[t] = {}, s.least[t] = no_key, s.lock[t] = 0;
    if (t == block_threads - 64) {
      s.origin = a.facts().origin;
      s.shifted = s.origin.x != 0 || s.origin.y != 0 || s.origin.z != 0;
      s.rigid = !a.placed || a.rest->rigid;
      s.pairs = s.given = s.kept = 0;
    }
  }

  /// Starts to copy the first nodes of each tree, its top levels: no point then waits for them. After `prepare`.
  static __device__ void fetch_tops(std::uint32_t count) {
    memory& s = here();
    const std::uint32_t stride = s.head.top_stride;
#pragma unroll 1
    for (std::uint32_t k = threadIdx.x / 64; k < count; k += warps / 2) {  // two warps a tree
      const auto& tree = view(k).tree;
      const std::uint32_t top = stride < tree.node_count ? stride : tree.node_count;
#pragma unroll 1
      for (std::uint32_t n = threadIdx.x % 64; n < top; n += 64) {
        fetch(s.top_nodes[k * stride + n], tree.nodes[n]);
        fetch(s.top_volumes[k * stride + n], tree.volumes[n]);
      }
    }
    __pipeline_commit();
  }

 private:
  /// Every thread first reads, and then writes: it waits once.
  template <class F>
  static __device__ void copy_parts(const frame_part* places, const PartView* views, std::uint32_t count, std::uint32_t thread, F meanwhile) {
    using word = std::conditional_t<sizeof(PartView) % sizeof(uint4) == 0, uint4, std::uint32_t>;
    constexpr std::uint32_t place_words = sizeof(frame_part) / sizeof(uint4), view_words = sizeof(PartView) / sizeof(word);
    static_assert(sizeof(frame_part) % sizeof(uint4) == 0 && sizeof(PartView) % sizeof(word) == 0);
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
  template <class T>
  static __device__ void fetch(T& to, const T& from) {
    constexpr std::size_t step = sizeof(T) % 16 == 0 ? 16 : sizeof(T) % 8 == 0 ? 8 : 4;
    if constexpr (sizeof(T) % step != 0 || alignof(T) < 4) {
      to = from;
    } else {
#pragma unroll
      for (std::size_t b = 0; b < sizeof(T); b += step)
        __pipeline_memcpy_async(reinterpret_cast<char*>(&to) + b, reinterpret_cast<const char*>(&from) + b, step);
    }
  }
};

}  // namespace clearance::stream
