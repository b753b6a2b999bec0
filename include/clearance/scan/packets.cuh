// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Neighbouring points walk the trees as packets: a warp walks once for 32 points, one per lane, and all lanes test the
// same node. A node is taken if any lane wants it, the nearest first. At a jump in depth the points before and behind
// it go one group after the other: if each lane walked alone, they would end last. Points that are not neighbours do
// walk alone. (A first test of children with a ball around the packet is slower: farther away it passes too many.)

#include <clearance/scan/lane_sharing.cuh>
#include <clearance/scan/lone_search.cuh>
#include <clearance/scan/shared_walk.cuh>

namespace clearance::scan {

/// A node that is no nearer than `bound` to any point of a packet.
template <class Node>
struct packet_node {
  real bound;
  Node node;
};

template <class Tally>
struct shared_packet_memory : block_memory<Tally> {
  using node_type = packet_node<typename node_of<typename block_memory<Tally>::hierarchy_type>::type>;
  alignas(16) node_type stack[warps][deepest_stack];
  sharing_memory<Tally> sharing;

  __device__ void clear() { sharing.clear(); }
};
template <class Tally>
struct packet_search : lone_search<Tally> {
  using frame = frame_parts<Tally>;
  using steps = tree_steps<Tally>;
  using hierarchy = typename Tally::part_type::hierarchy_type;
  using traits = bounding_volume_traits<typename hierarchy::volume_type>;
  using node_type = typename steps::node_type;
  using stacked = packet_node<node_type>;
  using sharing = shared_walk<Tally>;
  static constexpr bool begins_anew = false;  ///< A warp that helps begins with nothing found.
  using lone_search<Tally>::lane, lone_search<Tally>::inside, lone_search<Tally>::gap_to, lone_search<Tally>::alone;

  /// Waits for a part of another warp's packet, and for which of its lanes. Returns false if there is none left.
  static __device__ bool receive(given_lanes& work) {
    if (!sharing::receive()) return false;
    work = {sharing::task().packet, sharing::task().live};
    return true;
  }

  /// Searches for this lane's point `x`, in the cloud's frame, if it is `live`. The whole warp calls it. Returns the
  /// lanes that now have their answers; other warps may still work on the rest.
  template <class Visitor>
  static __device__ unsigned search(std::uint32_t packet, std::uint32_t, unsigned, bool live, vec3 x, Visitor& v) {
    groups(packet, live, x, v);
    return sharing::last(v) ? all_lanes : 0;
  }

 private:
  template <class Visitor>
  static __device__ void groups(std::uint32_t packet, bool live, vec3 x, Visitor& v) {
    unsigned left = __ballot_sync(all_lanes, live);
    if (left == 0) return;
    const bool helps = sharing::helps();
    if (!helps) sharing::begin(packet);
#pragma unroll 1
    while (left != 0) {
      const unsigned later = left >> 16 << 16;  // the middle one of neighbours in a row, if it is left
      const vec3 middle = from_lane(x, later != 0 ? __ffs(int(later)) - 1 : 31 - __clz(int(left)));
      const real way = rough_length(x - middle);
      unsigned near = left;
      if (!helps && !too_deep()) {
        const real most = gap_to(middle) / 2;
        near = __ballot_sync(all_lanes, live && way <= most);
        if (4 * __popc(near) < __popc(left)) {  // not neighbours
          v = alone(live, x, v);
          return;
        }
      }
      const bool its = (near >> lane() & 1) != 0;
      together(live && its, x, middle, from_bits(most_of(all_lanes, its ? to_bits(way) : 0)) * (1 + slack), v);
      live = live && !its, left &= ~near;
    }
  }

  static constexpr std::uint32_t at_once = most_children;
  static constexpr std::uint32_t worth_sharing = 4;  ///< So few pending nodes are tested faster than handed over.
  /// Searches part by part for points within `spread` of their middle.
  template <class Visitor>
  static __device__ void together(bool live, vec3 x, vec3 middle, real spread, Visitor& v) {
    const bool helps = sharing::helps();
    const std::uint32_t first = helps ? sharing::task().part : 0, end = helps ? first + 1 : frame::here().head.parts;
#pragma unroll 1
    for (std::uint32_t begin = first; begin < end; begin += 32) {  // one part per lane, the nearest first
      std::uint32_t mine = no_bound;
      if (begin + lane() < end) {
        const ball around = frame::place(begin + lane()).root.around;
        const real d = rough_length(middle - around.center);
        mine = ordered(lowered(d - around.radius - spread, d + around.radius + spread));
      }
#pragma unroll 1
      for (;;) {
        const std::uint32_t nearest = least_of(all_lanes, mine);
        if (nearest == no_bound) break;
        const std::uint32_t its = std::uint32_t(__ffs(int(__ballot_sync(all_lanes, mine == nearest)))) - 1,
                            k = begin + its;
        if (lane() == its) mine = no_bound;
        if (__any_sync(all_lanes, live && from_ordered(nearest) <= v.reach(k))) ask(k, live, x, v);
      }
    }
  }

  /// Trees may be too deep or wide for stacks in shared memory.
  static __device__ bool too_deep() {
    if constexpr (node_of<hierarchy>::any_size) return frame::here().head.overflow != nullptr;
    return false;
  }
  static __device__ stacked* own_stack() {
    auto& s = frame::here();
    if (too_deep())
      return reinterpret_cast<stacked*>(s.head.overflow) +
             std::size_t(blockIdx.x * warps + threadIdx.x / 32) * s.head.overflow_room;
    return s.stack[threadIdx.x / 32];
  }

  template <class Visitor>
  static __device__ void ask(std::uint32_t k, bool live, vec3 x, Visitor& v) {
    const frame_part& place = frame::place(k);
    const vec3 q = place.part_from_cloud(x);
    live = live && frames::may_reach(place.root.around, v.reach(k), x);
    if (live && !sharing::helps() && inside(k, x, v)) live = false;
    walk(k, live, q, v);
  }

  /// Walks part k's tree with all lanes together.
  template <class Visitor>
  static __device__ void walk(std::uint32_t k, bool live, vec3 q, Visitor& v) {
    sharing::talk(v);
    real reach = live ? v.reach(k) : -infinity;
    stacked* const stack = own_stack();
    const std::uint32_t given = sharing::task().nodes;
    std::uint32_t top = given != 0 ? given : 1;
    __syncwarp();
    if (lane() == 0 && given == 0) stack[0] = {-infinity, steps::root(k)};
#pragma unroll 1
    while (top > 0) {
      __syncwarp();  // all pushes are visible
      const stacked e = stack[--top];
      if (!__any_sync(all_lanes, e.bound <= reach)) continue;
      const std::uint32_t count = steps::size(k, e.node);
      if (steps::is_leaf(k, e.node)) {
#pragma unroll 1
        for (std::uint32_t j = 0; j < count; ++j) {
          const auto place = steps::place_of(e.node, j);
          const auto primitive = steps::primitive(k, place);
          if constexpr (bounded_primitive<typename hierarchy::primitive_type>)  // a rough test is enough for most
            if (__all_sync(all_lanes, primitive.lower_bound(q) > reach)) continue;
          if (const real d = primitive.distance(q); d <= reach)
            v.offer(k, place, steps::id(k, place), d), reach = v.reach(k);
        }
        continue;
      }
#pragma unroll 1
      for (std::uint32_t begin = 0; begin < count; begin += at_once)
        top = push(k, e.node, begin, count, q, reach, stack, top);
      if (top > worth_sharing && sharing::asked() && !too_deep()) {
        sharing::talk(v);
        reach = min(reach, v.reach(k));
        sharing::hand_over(k, reach, v, frame::here().stack, top);
      }
    }
  }

  /// Pushes those of eight children that some point wants, the nearest on top. Returns the stack's new size.
  static __device__ std::uint32_t push(std::uint32_t k, const node_type& node, std::uint32_t begin, std::uint32_t count,
                                       vec3 q, real reach, stacked* stack, std::uint32_t top) {
    constexpr std::uint32_t unwanted = none,
                            number =
                                at_once - 1;  // the lowest bits of a bound hold the child's number, so no two are equal
    std::uint32_t low[at_once];
#pragma unroll
    for (std::uint32_t four = 0; four < at_once; four += 4) {
      if (begin + four >= count) {
#pragma unroll
        for (std::uint32_t h = four; h < four + 4; ++h) low[h] = unwanted;
        continue;
      }
#pragma unroll
      for (std::uint32_t h = four; h < four + 4; ++h) {
        const std::uint32_t j = lower_of(begin + h, count - 1);  // without a branch, so that all four are read at once
        const real b = traits::lower_bound(steps::child(k, node, j).volume, q);
        low[h] = least_of(all_lanes, begin + h < count && b <= reach ? (ordered(b) & ~number) | h : unwanted);
      }
    }
    std::uint32_t mine = unwanted, nearer = 0, all = 0;  // one child per lane
#pragma unroll
    for (std::uint32_t h = 0; h < at_once; ++h) mine = lane() == h ? low[h] : mine;
#pragma unroll
    for (std::uint32_t h = 0; h < at_once; ++h) all += low[h] != unwanted, nearer += low[h] < mine;
    __syncwarp();  // all have read the node
    if (mine != unwanted)
      stack[top + all - 1 - nearer] = {from_ordered(mine & ~number), steps::child(k, node, begin + lane()).node};
    return top + all;
  }
};

}  // namespace clearance::scan
