// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Many configurations down a tree over a cloud's points, on a device.

#include <clearance/answer/batch_arguments.hpp>
#include <clearance/scan/threads.cuh>

namespace clearance::minimum {

/// A warp's own memory: nodes that are still to be opened, each for one part, and pairs of a node or point and a part that are to be
/// looked at.
struct batch_room {
  static constexpr std::uint32_t depth = 256, queue = 64;
  struct pending {
    real bound;
    std::uint32_t node, part;
  };
  pending stack[depth];
  std::uint32_t what[queue], whose[queue];
};

/// A block is a configuration, whose parts its warps take in turn; they share its bound. A warp opens nodes, nearest first, each by a
/// lane a child, until 32 pairs are within reach of a part's ball: then each lane takes one of those down its part's tree.
template <class PartView, class Tree>
__global__ void __launch_bounds__(256) batch_kernel(const __grid_constant__ batch_arguments<PartView> a, const __grid_constant__ Tree tree) {
  using body_type = typename batch_arguments<PartView>::body_type;
  using scan::all_lanes;
  constexpr std::uint32_t is_point = 1u << 31;
  extern __shared__ batch_room rooms[];
  __shared__ alignas(totals) std::byte memory[sizeof(totals)];
  __shared__ std::uint32_t next_part;
  totals& best = *reinterpret_cast<totals*>(memory);
  const std::uint32_t c = blockIdx.x, lane = threadIdx.x % 32;
  if (threadIdx.x == 0) best = a.all[c], next_part = 0;
  __syncthreads();
  const body_type body = a.body(c, &best);
  const tree_search<body_type, Tree> search{body, tree, a.bounds + std::size_t(c) * a.part_count};
  for (std::uint32_t i = threadIdx.x; i < 3 * a.part_count; i += blockDim.x)  // where it, and its neighbours, were nearest
    if (const std::uint32_t from = c + i / a.part_count - 1; from < a.configurations && a.facts[c].rigid)
      if (const auto seed = a.seeds[from]; seed.number != none) search.visit(seed, i % a.part_count);
  __syncthreads();

  batch_room& room = rooms[threadIdx.x / 32];
  std::uint32_t pending = 0, queued = 0;
  const auto enqueue = [&](bool mine, std::uint32_t what, std::uint32_t whose) {
    const unsigned those = __ballot_sync(all_lanes, mine);
    if (const std::uint32_t at = queued + __popc(those & ((1u << lane) - 1)); mine) room.what[at] = what, room.whose[at] = whose;
    queued += __popc(those);
    __syncwarp();
  };
  // Of a node around `around` that is not nearer to part k than `bound`.
  const auto open_nodes = [&](std::uint32_t level, std::uint32_t begin, std::uint32_t end, const ball& around, real bound, std::uint32_t k) {
    const std::uint32_t node = tree.begin[level] + begin + lane;
    bool mine = begin + lane < end;
    if (mine) {
      const ball b = tree.balls[node];
      mine = search.may_reach(around, bound, b.center, b.radius) && search.may_reach(b, k);
    }
    enqueue(mine, node, k);
  };
  const auto open_points = [&](std::uint32_t begin, std::uint32_t end, const ball& around, real bound, std::uint32_t k) {
    const std::uint32_t i = begin + lane;
    bool mine = i < end;
    if (mine) {
      const vec3 at = tree.points[i].at;
      mine = search.may_reach(around, bound, at, 0) && frames::may_reach(body.places[k].around, search.reach(), at - body.origin);
    }
    enqueue(mine, i, k | is_point);
  };
  /// Up to 32 pairs; of the nodes among them the nearest will be opened first.
  const auto look = [&] {
    const std::uint32_t take = scan::lower_of(queued, 32);
    queued -= take;
    real bound = infinity;
    std::uint32_t what = 0, whose = 0;
    if (lane < take) {
      what = room.what[queued + lane], whose = room.whose[queued + lane];
      if ((whose & is_point) != 0)
        search.visit(tree.points[what], whose & ~is_point);
      else
        bound = search.look(tree.balls[what], whose);
    }
    const bool mine = bound < infinity;
    const unsigned those = __ballot_sync(all_lanes, mine);
    if (those == 0) return;
    distance_key order = no_key;
    if (mine) order = search.order(bound, tree.least[what]);
    std::uint32_t below = 0;
    for (unsigned left = those; left != 0; left &= left - 1) {
      const int other = __ffs(int(left)) - 1;
      const distance_key its = __shfl_sync(all_lanes, order, other);
      below += its > order || (its == order && std::uint32_t(other) > lane);
    }
    if (mine) room.stack[pending + below] = {bound, what, whose};
    pending += __popc(those);
    __syncwarp();
  };
  const auto open_next = [&] {
    const batch_room::pending top = room.stack[--pending];
    __syncwarp();
    // Lanes may see bounds of different moments; what one knows is true for all.
    if (__any_sync(all_lanes, search.settled(top.bound, tree.least[top.node]))) return;
    std::uint32_t level = 0;
    while (top.node >= tree.begin[level + 1]) ++level;
    const std::uint32_t node = top.node - tree.begin[level];
    const ball around = tree.balls[top.node];
    const std::uint32_t first = tree.first_below(level, node), behind = tree.end_below(level, node);
    if (level == 0) return open_points(first, behind, around, top.bound, top.part);
    if (pending + 64 <= batch_room::depth) return open_nodes(level - 1, first, behind, around, top.bound, top.part);
    std::uint64_t begin = node, end = node + 1;  // no room for what is below it: all its points at once
    for (std::uint32_t l = 0; l <= level; ++l) begin *= l == 0 ? Tree::tile : Tree::fan, end *= l == 0 ? Tree::tile : Tree::fan;
    end = end < tree.count ? end : tree.count;
    for (; begin < end; begin += 32) {
      open_points(std::uint32_t(begin), std::uint32_t(end), around, top.bound, top.part);
      if (queued >= 32) look();
    }
  };

  for (bool more = tree.levels != 0 && a.facts[c].rigid; more || pending > 0 || queued > 0;) {
    while (queued < 32 && (more || pending > 0)) {
      if (more && pending <= 32) {
        std::uint32_t k = 0;
        if (lane == 0) k = atomicAdd(&next_part, 1u);
        k = __shfl_sync(all_lanes, k, 0);
        more = k < a.part_count;
        if (more) open_nodes(tree.levels - 1, 0, tree.size(tree.levels - 1), {}, -infinity, k);
      } else if (pending > 0) {
        open_next();
      }
    }
    if (queued > 0) look();
  }
  __syncthreads();
  if (threadIdx.x == 0) a.all[c] = best;
}

}  // namespace clearance::minimum
