// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The whole frame in one kernel: every point is read once and tested against all parts' balls in its own frame; the few
// that survive go into the block's queue of (point, node) pairs, eight lanes to a pair, so that a survivor costs the
// depth of the tree in rounds and not the length of one thread's walk. The last block to finish writes the answer.

#include <clearance/query/any_within.hpp>
#include <clearance/stream/block.cuh>
#include <clearance/stream/finish.cuh>
#include <clearance/traversal/near_first.hpp>

namespace clearance::stream {

template <class PartView, class Source>
struct frame {
  using args_type = frame_args<PartView, Source>;
  using hierarchy = typename PartView::hierarchy_type;
  using traits = bounding_volume_traits<typename hierarchy::volume_type>;
  static constexpr bool has_interior = !requires { PartView::interior_type::empty; };
  using memory = block_memory<PartView>;
  static constexpr int quad = 4;

  const args_type& a;
  memory& s;
  unsigned long long dropped = 0;  ///< By reason, 16 bits each.

  __device__ void run() {
    const std::uint32_t t = threadIdx.x;
    // Neighbouring points share their fate: the chunks of 128 are dealt out, so that they meet in no block.
    constexpr std::uint32_t chunk = 32 * quad, warps = block_threads / 32;
    const std::uint32_t stride = chunk * warps * gridDim.x;
    std::uint32_t at = (t / 32 * gridDim.x + blockIdx.x) * chunk;
    points p = load(at);
    prepare(t);
    __syncthreads();
    if (!__syncthreads_or(from_last_frame(t))) seed(p);
    for (std::uint32_t k = t; k < a.parts; k += block_threads) s.sharpen(k, part(k).place.around);
    __syncthreads();
    const std::uint32_t rounds = (a.points + stride - 1) / stride;
    for (std::uint32_t r = 0; r < rounds; ++r, at += stride) {
      const bool more = r + 1 < rounds;
      points next = p;
      if (more) next = load(at + stride);
      filter(at, p);
      if (more) {
        p = next;
        if (t == 0) atomicMin(&s.bound, fresh(a.state->bound));
        if (t - 32 < a.parts && t >= 32) s.sharpen(t - 32, part(t - 32).place.around);
        if (!__syncthreads_or(s.candidates > memory::candidate_capacity / 4)) continue;
      }
      drain();
    }
    count_dropped();
    __syncthreads();
    finish_block(a, s);
  }

 private:
  /// Index of a thread's j-th point: four in a row where the source loads four at once, else a warp's width apart.
  __device__ static std::uint32_t index(const Source& source, std::uint32_t at, int j) {
    return at + (together(source) ? (threadIdx.x & 31) * quad + j : (threadIdx.x & 31) + 32 * j);
  }
  __device__ static bool together(const Source& source) {
    if constexpr (requires(sample (&out)[quad]) { source.load4(std::size_t(0), out); })
      return source.loads4();
    else
      return false;
  }
  /// A thread's points, and a byte for each: 0 valid, else why not.
  struct points {
    vec3 at[quad];
    std::uint32_t why;
  };
  static constexpr std::uint32_t absent = 0xff;

  __device__ points load(std::uint32_t at) const {
    points p;
    sample s[quad];
    bool read = false;
    if constexpr (requires { a.source.load4(std::size_t(0), s); }) {
      read = a.source.loads4() && at + 32 * quad <= a.points;
      if (read) a.source.load4(at + (threadIdx.x & 31) * quad, s);
    }
    if (!read)
#pragma unroll
      for (int j = 0; j < quad; ++j) {
        const std::uint32_t i = index(a.source, at, j);
        s[j] = i < a.points ? a.source[i] : sample{{0, 0, 0}, drop_reason(absent)};
      }
    p.why = 0;
#pragma unroll
    for (int j = 0; j < quad; ++j) {
      p.at[j] = s[j].position - a.origin;
      p.why |= std::uint32_t(s[j].dropped) << 8 * j;
    }
    return p;
  }

  __device__ const stream_part<PartView>& part(std::uint32_t k) const { return stream::part(a, s, k); }
  __device__ vec3 in_part(std::uint32_t k, vec3 position) const { return part(k).place.part_from_cloud(position - a.origin); }

  /// Parts go to shared memory: kernel arguments live behind the constant cache, a miss of which costs more than a round.
  __device__ void prepare(std::uint32_t t) {
    static_assert(sizeof(stream_part<PartView>) % sizeof(std::uint32_t) == 0);
    const std::uint32_t inside = a.parts < inline_parts ? a.parts : inline_parts;
    const auto* from = reinterpret_cast<const std::uint32_t*>(a.part);
    auto* to = reinterpret_cast<std::uint32_t*>(s.parts);
    for (std::uint32_t i = t; i < inside * (sizeof(stream_part<PartView>) / 4); i += block_threads) to[i] = from[i];
    if (t < drop_reasons) s.dropped[t] = 0;
    if (t == 0) {
      s.bound = 0xff800000u, s.candidates = s.queued[0] = s.queued[1] = s.lock = 0;
      s.best = {};
    }
  }

  /// Any real pair gives a valid bound; last frame's minima and their neighbours, moved a little, give a very good one.
  __device__ bool from_last_frame(std::uint32_t t) {
    const std::uint32_t witnesses = a.state->witnesses, each = block_threads / frame_state::kept;
    if (t >= witnesses * each) return false;
    const record w = a.state->witness[t / each];
    const std::uint32_t point = key_index(w.key) + t % each - (t % each == 0 ? 0 : each / 2);
    if (w.part >= a.parts || w.primitive == none || point >= a.points) return false;
    const sample p = a.source[point];
    if (!p.valid()) return false;
    const real d = part(w.part).view.tree.primitives[w.primitive].distance(in_part(w.part, p.position));
    if (d < infinity) atomicMin(&s.bound, ordered(d));
    return d < infinity;
  }

  /// No last frame: eight lanes take the most promising of their points down the tree, and all blocks wait a little for
  /// one another. Nothing depends on that wait but speed, so it gives up rather than hang.
  __noinline__ __device__ void seed(const points& p) {
    real nearest = infinity;
    std::uint32_t nearest_part = 0;
    vec3 position{0, 0, 0};
    for (int j = 0; j < quad; ++j) {
      if (p.why >> 8 * j & 0xff) continue;
      for (std::uint32_t k = 0; k < a.parts; ++k) {
        const ball& around = part(k).place.around;
        const real lb = length(p.at[j] - around.center) - around.radius;
        if (lb < nearest) nearest = lb, nearest_part = k, position = p.at[j];
      }
    }
    real least = nearest;
    for (int step = 1; step < lanes; step *= 2) least = min(least, __shfl_xor_sync(~0u, least, step));
    const unsigned mine = 0xffu << (threadIdx.x & 24);
    const unsigned winners = __ballot_sync(~0u, nearest == least && least < infinity) & mine;
    if (winners != 0) {
      const int from = __ffs(int(winners)) - 1;
      nearest_part = __shfl_sync(mine, nearest_part, from);
      position = {__shfl_sync(mine, position.x, from), __shfl_sync(mine, position.y, from), __shfl_sync(mine, position.z, from)};
      descend(nearest_part, part(nearest_part).place.part_from_cloud(position), mine);
    }
    __syncthreads();
    if (threadIdx.x == 0) {
      atomicMin(&a.state->bound, s.bound);
      __threadfence();
      atomicAdd(&a.state->seeded, 1u);
      const long long start = clock64();
      while (fresh(a.state->seeded) < gridDim.x && clock64() - start < 20000) {
      }
      atomicMin(&s.bound, fresh(a.state->bound));
    }
    __syncthreads();
  }

  /// Greedily to one leaf, and the distance to what is there.
  __device__ void descend(std::uint32_t k, vec3 q, unsigned mine) {
    const hierarchy& tree = part(k).view.tree;
    const std::uint32_t lane = threadIdx.x & (lanes - 1);
    bvh_node n = tree.nodes[0];
    while (!n.is_leaf()) {
      const bool real_child = lane < n.count();
      const std::uint32_t c = n.first + (real_child ? lane : 0);
      const bvh_node child = tree.nodes[c];
      const real lb = real_child ? traits::lower_bound(tree.volumes[c], q) : infinity;
      real least = lb;
      for (int step = 1; step < lanes; step *= 2) least = min(least, __shfl_xor_sync(mine, least, step));
      const unsigned winners = __ballot_sync(mine, lb == least && real_child) & mine;
      if (winners == 0) return;
      const int from = __ffs(int(winners)) - 1;
      n = {__shfl_sync(mine, child.first, from), __shfl_sync(mine, child.count_and_kind, from)};
    }
    real d = infinity;
    for (std::uint32_t k = lane; k < n.count(); k += lanes) d = min(d, tree.primitives[n.first + k].distance(q));
    if (d < infinity) atomicMin(&s.bound, ordered(d));
  }

  /// Three multiply-adds and a minimum for each point and part; whoever passes any test is looked at again.
  __device__ void filter(std::uint32_t at, points& p) {
    if (p.why != 0) count_and_remove(p);
    real least[quad];
#pragma unroll
    for (int j = 0; j < quad; ++j) least[j] = infinity;
#pragma unroll 4
    for (std::uint32_t k = 0; k < a.parts; ++k) {
      const root_test root = s.roots[k];
#pragma unroll
      for (int j = 0; j < quad; ++j) least[j] = min(least[j], root(p.at[j]));
    }
#pragma unroll
    for (int j = 0; j < quad; ++j) {
      if (!(least[j] <= -dot(p.at[j], p.at[j]))) continue;
      const std::uint32_t slot = atomicAdd(&s.candidates, 1u), point = index(a.source, at, j);
      if (slot < memory::candidate_capacity)
        s.candidate_table[slot] = {p.at[j], point};
      else
        alone(p.at[j], point);
    }
  }
  __device__ void count_and_remove(points& p) {
#pragma unroll
    for (int j = 0; j < quad; ++j) {
      const std::uint32_t why = p.why >> 8 * j & 0xff;
      if (why == 0) continue;
      if (why != absent) dropped += 1ull << 16 * (why - 1);
      p.at[j] = {not_a_number, not_a_number, not_a_number};  // fails every comparison
    }
  }

  __device__ void count_dropped() {
    if (!__any_sync(~0u, dropped != 0)) return;
    for (int r = 1; r < drop_reasons; ++r) {
      const unsigned sum = __reduce_add_sync(~0u, unsigned(dropped >> 16 * (r - 1)) & 0xffffu);
      if ((threadIdx.x & 31) == 0 && sum != 0) atomicAdd(&s.dropped[r], sum);
    }
  }

  /// One pair of a candidate and a part: into the queue, unless it ends here. No tree is touched yet.
  __device__ void admit(const candidate& c, std::uint32_t k) {
    if (!(s.roots[k](c.x) <= -dot(c.x, c.x))) return;
    const auto& body = part(k);
    const vec3 q = body.place.part_from_cloud(c.x);
    if (inside(body, q, c.point, k)) return;
    s.survivor_table[threadIdx.x] = {q, c.point, k};
    push({-infinity, body.root, threadIdx.x}, 0);
  }

  /// Is the point in the part's solid? Then its distance is 0, and there is nothing to look for in the tree.
  __device__ bool inside(const stream_part<PartView>& body, vec3 q, std::uint32_t point, std::uint32_t k) {
    if constexpr (has_interior) {
      if (s.best_key() <= make_key(0, point) && load_relaxed(&a.state->certain) != 0) return true;
      if (!body.view.interior.inside(q)) return false;
      s.lower(0, *a.state);
      s.offer({make_key(0, point), k, none, none});
      any_within surface{body.place.error + body.view.facts.tolerance};
      near_first{}(body.view.tree, q, surface);
      if (!surface.found) atomicAdd(&a.state->certain, 1ull);
      return true;
    }
    return false;
  }
  __device__ void push(const pending& e, int parity) {
    const std::uint32_t slot = atomicAdd(&s.queued[parity], 1u);
    if (slot < memory::queue_capacity) {
      s.queue[slot] = e;
    } else {  // exact, only slower
      const survivor v = s.survivor_table[e.survivor];
      alone(e.node, v.q, v.point, v.part);
    }
  }
  __noinline__ __device__ void alone(bvh_node top, vec3 q, std::uint32_t point, std::uint32_t k) {
    const PartView& view = part(k).view;
    block_nearest<PartView> ask{&s, a.state, &view, point, k};
    near_first{}(subtree<hierarchy>{view.tree, top}, q, ask);
  }
  __noinline__ __device__ void alone(vec3 x, std::uint32_t point) {
    for (std::uint32_t k = 0; k < a.parts; ++k) {
      if (!(s.roots[k](x) <= -dot(x, x))) continue;
      const vec3 q = part(k).place.part_from_cloud(x);
      if (!inside(part(k), q, point, k)) alone(part(k).root, q, point, k);
    }
  }

  /// All candidates against all parts, as many pairs at a time as there are threads.
  __device__ void drain() {
    __syncthreads();
    const std::uint32_t count = s.candidates < memory::candidate_capacity ? s.candidates : memory::candidate_capacity;
    const std::uint32_t pairs = count * a.parts;
    for (std::uint32_t base = 0; base < pairs; base += block_threads) {
      const std::uint32_t i = base + threadIdx.x;
      if (i < pairs) admit(s.candidate_table[i % count], i / count);
      walk();
    }
    if (threadIdx.x == 0) s.candidates = 0;
    __syncthreads();
  }

  /// Takes pairs from the queue's end, 64 at a time, until it is empty.
  __device__ void walk() {
    const std::uint32_t group = threadIdx.x / lanes;
    for (int parity = 0;; parity ^= 1) {
      __syncthreads();
      const std::uint32_t wanted = s.queued[parity];
      const std::uint32_t queued = wanted < block_memory<PartView>::queue_capacity ? wanted : block_memory<PartView>::queue_capacity;
      if (queued == 0) break;
      const std::uint32_t taken = queued < groups ? queued : std::uint32_t(groups), base = queued - taken;
      const bool busy = group < taken;
      const pending e = busy ? s.queue[base + group] : pending{};
      if (threadIdx.x == 0) s.queued[parity ^ 1] = base;
      if (threadIdx.x == block_threads - 1) atomicMin(&s.bound, fresh(a.state->bound));
      __syncthreads();
      if (busy && e.bound <= s.reach()) expand(e, parity ^ 1);
    }
    if (threadIdx.x == 0) s.queued[0] = s.queued[1] = 0;
    __syncthreads();
  }

  __device__ void expand(const pending& e, int parity) {
    const survivor v = s.survivor_table[e.survivor];
    const PartView& view = part(v.part).view;
    const hierarchy& tree = view.tree;
    const std::uint32_t lane = threadIdx.x & (lanes - 1);
    for (std::uint32_t k = lane; k < e.node.count(); k += lanes) {
      const std::uint32_t place = e.node.first + k;
      if (e.node.is_leaf()) {
        const block_nearest<PartView> ask{&s, a.state, &view, v.point, v.part};
        ask.offer(place, tree.primitives[place].distance(v.q));
      } else {
        const bvh_node child = tree.nodes[place];
        const real lb = traits::lower_bound(tree.volumes[place], v.q);
        if (lb <= s.reach()) push({lb, child, e.survivor}, parity);
      }
    }
  }
};

template <class PartView, class Source>
__global__ void __launch_bounds__(block_threads, 2) stream_kernel(const __grid_constant__ frame_args<PartView, Source> args) {
  __shared__ block_memory<PartView> memory;
  frame<PartView, Source>{args, memory}.run();
}

}  // namespace clearance::stream
