// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Packets for trees whose volumes and primitives know their tangents.

#include <clearance/result.hpp>
#include <clearance/scan/lane_sharing.cuh>
#include <clearance/scan/lone_search.cuh>
#include <clearance/scan/packets.cuh>
#include <clearance/scan/seen_memory.hpp>

namespace clearance::scan {

// A warp walks once for points that lie together, from their middle, with its lanes going over nodes and primitives
// instead of points. A half-space that contains a node bounds its distance for all points at once (yardstick.hpp), so
// few primitives are left. Each point then tests those exactly that it may need.

template <class Tally, class Visitor>
struct tangent_walk : tree_steps<Tally> {
  using frame = frame_parts<Tally>;
  using steps = tree_steps<Tally>;
  using hierarchy = typename Tally::part_type::hierarchy_type;
  using traits = bounding_volume_traits<typename hierarchy::volume_type>;

  /// For the points `x` of lanes that are `live`. The whole warp calls it.
  static __device__ void search(bool live, std::uint32_t index, vec3 x, Visitor& v) {
    tangent_walk w(live, x, v);
    w.walk(index);
  }

 private:
  seen_memory& s;
  const bool live;
  const vec3 x;
  Visitor& v;
  std::uint32_t inner = none;  ///< The first part that this lane's point is inside of.
  std::uint32_t top = 0, leaves = 0, candidates = 0;

  __device__ tangent_walk(bool has_point, vec3 at, Visitor& visitor)
      : s(frame::here().seen[threadIdx.x / 32]), live(has_point), x(at), v(visitor) {
    const auto least = [&](real a) { return from_ordered(least_of(all_lanes, has_point ? ordered(a) : no_bound)); };
    const auto most = [&](real a) { return from_ordered(most_of(all_lanes, has_point ? ordered(a) : 0)); };
    const auto largest = [&](real a) { return from_bits(most_of(all_lanes, has_point ? to_bits(absolute(a)) : 0)); };
    const vec3 middle{(least(x.x) + most(x.x)) / 2, (least(x.y) + most(x.y)) / 2, (least(x.z) + most(x.z)) / 2};
    const vec3 e = x - middle, half{largest(e.x), largest(e.y), largest(e.z)};
    const real radius = largest(rough_length(e)) * (1 + slack);
    __syncwarp();  // all have read what is there of the points before
    if (lane() == 0) {
      s.points = {.middle = middle,
                  .limit = infinity,
                  .half = half,
                  .noise = 0,
                  .best = {},
                  .within = infinity,
                  .radius = radius};
      s.reach = infinity;
    }
    __syncwarp();
  }

  static __device__ std::uint32_t lane() { return threadIdx.x % 32; }
  static __device__ std::uint32_t before(unsigned those) { return std::uint32_t(__popc(those & ((1u << lane()) - 1))); }
  /// The points' reaches have shrunk.
  __device__ void limit() {
    const std::uint32_t most = most_of(all_lanes, live ? ordered(v.reach(0)) : 0);
    if (lane() == 0) {
      s.reach = from_ordered(most);
      s.points.set_limit(s.reach);
    }
    __syncwarp();
  }
  /// From shared memory, sixteen bytes at once.
  template <class T>
  static __device__ T loaded(const T& from) {
    static_assert(sizeof(T) % sizeof(uint4) == 0);
    as_words<T, uint4> of;
#pragma unroll
    for (std::size_t i = 0; i < sizeof(T) / sizeof(uint4); ++i) of.words[i] = reinterpret_cast<const uint4*>(&from)[i];
    return of.value;
  }

  /// Each round looks at what is pending: first at what is remembered, then at nodes and at primitives. There is one
  /// place for each step, because code has to be read, too.
  __device__ void walk(std::uint32_t index) {
    const std::uint32_t parts = frame::here().head.parts;
    std::uint32_t begin = 0;
    bool remembered = true;

#pragma unroll 1
    for (;;) {
      const bool full = leaves >= seen_memory::leaves_at_once, nodes = top > 0 || begin < parts,
                 primitives = remembered || full || (leaves > 0 && (!nodes || s.points.best.most == infinity)),
                 over = !primitives && !nodes;

      if (over || candidates > seen_memory::most_candidates - 32) {
        forget();
        if (over || candidates > seen_memory::most_candidates - 32) measure();
        if (over) return;
      }
      if (!primitives) {
        open(begin);
        continue;
      }

      primitive_of_part primitive{none, 0};
      if (!remembered) {
        primitive = take_leaves();
      } else {
        if (live) primitive = Tally::known(frame::here(), index);
        if (lane() == 0 && primitive.part == none) primitive = s.hint;
        if (primitive.part >= parts) primitive.part = none;
      }
      examine(primitive, !remembered);
      remembered = false;
    }
  }

  /// Looks at nodes: those of the next 32 parts, or eight children of each of four nodes.
  __device__ void open(std::uint32_t& begin) {
    seen_node e{};
    bool has;
    if (top == 0) {
      e.part = begin + lane();
      begin += 32;
      has = e.part < frame::here().head.parts;
      real noise = 0;
      if (has) {
        const frame_part& place = frame::place(e.part);
        const seen_part seen(s.points, place.root.around, place.part_from_cloud(s.points.middle));
        e.distance = seen.distance;
        noise = seen.noise;
        e.node = steps::root(e.part);
      }

      noise = from_bits(most_of(all_lanes, to_bits(noise)));
      if (lane() == 0) s.points.noise = max(s.points.noise, noise);
      inside(e.part - lane(), has && e.distance <= s.points.radius + noise);
      limit();
      has = has && e.distance <= s.points.limit;
    } else {
      const std::uint32_t m = top > seen_memory::many ? 1 : lower_of(top, seen_memory::at_once), place = lane() / 8;
      has = place < m;
      if (has) {
        e = s.nodes[top - 1 - place];
        has = e.distance <= s.points.limit && lane() % 8 < e.node.count();
      }

      top -= m;
      if (has) {
        const auto child = steps::whole_child(e.part, e.node, lane() % 8);
        const rigid_transform part_from_cloud = loaded(frame::place(e.part).part_from_cloud);
        const surroundings points = loaded(s.points);
        const tangent t = traits::tangent_at(child.volume, part_from_cloud(points.middle));
        e.node = child.node;
        e.distance = t.distance;
        has = points.keeps(t.distance, to_cloud(part_from_cloud, t.direction));
      }
      __syncwarp();  // all have read the stack
    }
    push(has, e);
  }

  /// Leaves go to the leaves, other nodes on the stack, the nearest on top.
  __device__ void push(bool wanted, const seen_node& e) {
    const bool leaf = wanted && e.node.is_leaf();
    const unsigned of_leaves = __ballot_sync(all_lanes, leaf);
    if (leaf) s.leaves[leaves + before(of_leaves)] = e;
    leaves += std::uint32_t(__popc(of_leaves));
    std::uint32_t mine = wanted && !leaf ? ordered(e.distance) : 0;
#pragma unroll 1
    for (;;) {
      const std::uint32_t farthest = most_of(all_lanes, mine);
      if (farthest == 0) break;
      const unsigned pushed = __ballot_sync(all_lanes, mine == farthest);
      if (mine == farthest) {
        s.nodes[top + before(pushed)] = e;
        mine = 0;
      }
      top += std::uint32_t(__popc(pushed));
    }
    __syncwarp();
  }

  /// Are points inside of solids? `perhaps`: it may be so for part begin + lane.
  __device__ void inside(std::uint32_t begin, bool perhaps) {
    if constexpr (has_interior<typename Tally::part_type>) {
#pragma unroll 1
      for (unsigned lanes = __ballot_sync(all_lanes, perhaps); lanes != 0; lanes &= lanes - 1) {
        const std::uint32_t k = begin + std::uint32_t(__ffs(int(lanes))) - 1;
        if (live && is_inside<Tally>(k, x)) {
          v.offer_inside(k);
          inner = lower_of(inner, k);
        }
        __syncwarp();
      }
    }
  }

  /// Four primitives of each of eight leaves, one for each lane. What is left of the leaves stays.
  __device__ primitive_of_part take_leaves() {
    const std::uint32_t m = lower_of(leaves, seen_memory::leaves_at_once), j = lane() % 4;
    seen_node e{};
    std::uint32_t count = 0;
    if (lane() / 4 < m) {
      e = s.leaves[leaves - 1 - lane() / 4];
      if (e.distance <= s.points.limit) count = e.node.count();
    }
    leaves -= m;
    __syncwarp();  // all have read them
    const unsigned rest = __ballot_sync(all_lanes, j == 0 && count > 4);
    if (rest >> lane() & 1)
      s.leaves[leaves + before(rest)] = {e.distance, {e.node.first + 4, (count - 4) | bvh_node::leaf_bit}, e.part};
    leaves += std::uint32_t(__popc(rest));
    __syncwarp();
    return j < count ? primitive_of_part{e.part, e.node.first + j} : primitive_of_part{none, 0};
  }

  /// Looks at a primitive in each lane. `finds`: those that may be nearest to a point become candidates.
  __device__ void examine(primitive_of_part primitive, bool finds) {
    const bool has = primitive.part != none;
    vec3 u{};
    real distance = 0, most = 0;
    yardstick mine;
    if (has) {
      const rigid_transform part_from_cloud = loaded(frame::place(primitive.part).part_from_cloud);
      const auto t =
          steps::whole_primitive(primitive.part, primitive.place).tangent_at(part_from_cloud(s.points.middle));
      u = to_cloud(part_from_cloud, t.direction);
      distance = t.distance;
      most = t.most;
      mine = yardstick(t, u, s.points.radius);
    }

    const std::uint32_t key = ordered(mine.most), least = least_of(all_lanes, key);
    if (from_ordered(least) < s.points.best.most) {  // the nearest becomes the yardstick
      const unsigned nearest = __ballot_sync(all_lanes, key == least);
      __syncwarp();  // all have read the last one
      if (lane() + 1 == std::uint32_t(__ffs(int(nearest)))) {
        s.points.best = mine;
        s.points.within = most + s.points.radius;
        s.hint = primitive;
        s.points.set_limit(s.reach);
      }
      __syncwarp();
    }

    const bool wanted = has && finds && s.points.keeps(distance, u);
    const unsigned added = __ballot_sync(all_lanes, wanted);
    if (wanted) {
      const std::uint32_t at = candidates + before(added);
      s.candidates[at] = {u, distance};
      s.which[at] = primitive;
    }
    candidates += std::uint32_t(__popc(added));
    __syncwarp();
  }

  /// Drops candidates that the yardstick of now does not keep.
  __device__ void forget() {
    std::uint32_t left = 0;
#pragma unroll 1
    for (std::uint32_t begin = 0; begin < candidates; begin += 32) {
      seen_primitive c{};
      primitive_of_part which{};
      bool keep = begin + lane() < candidates;
      if (keep) {
        c = s.candidates[begin + lane()];
        which = s.which[begin + lane()];
        keep = s.points.keeps(c.distance, c.direction);
      }
      const unsigned kept = __ballot_sync(all_lanes, keep);
      __syncwarp();
      if (keep) {
        s.candidates[left + before(kept)] = c;
        s.which[left + before(kept)] = which;
      }
      left += std::uint32_t(__popc(kept));
      __syncwarp();
    }
    candidates = left;
  }

  /// May this lane's point be nearest to candidate j?
  __device__ bool needs(std::uint32_t j, vec3 e) const {
    const seen_primitive c = s.candidates[j];
    const std::uint32_t part = s.which[j].part;
    return s.points.may_reach(c.distance, c.direction, e, v.reach(part)) && part != inner;
  }

  /// Each point tests the candidates that it may be nearest to, first the nearest to the middle.
  __device__ void measure() {
    std::uint32_t key = no_bound, first = 0;
    for (std::uint32_t j = lane(); j < candidates; j += 32)
      if (const std::uint32_t d = ordered(s.candidates[j].distance); d < key) {
        key = d;
        first = j;
      }
    const std::uint32_t least = least_of(all_lanes, key);
    first = __shfl_sync(all_lanes, first, __ffs(int(__ballot_sync(all_lanes, key == least))) - 1);

    const vec3 e = x - s.points.middle;
    unsigned long long mine =
        live && candidates > 0 ? 1ull << first : 0;  // each lane goes over its own, one after the other
    bool chosen = false;

#pragma unroll 1
    for (;;) {
      if (!__any_sync(all_lanes, mine != 0)) {
        if (chosen) break;
        chosen = true;
#pragma unroll 1
        for (std::uint32_t j = 0; j < candidates; ++j)
          if (live && j != first && needs(j, e)) mine |= 1ull << j;
        continue;
      }
      if (mine != 0) {
        const std::uint32_t j = std::uint32_t(__ffsll(static_cast<long long>(mine))) - 1;
        mine &= mine - 1;
        if (needs(j, e)) {
          const primitive_of_part which = s.which[j];
          const vec3 q = loaded(frame::place(which.part).part_from_cloud)(x);
          const real d = steps::whole_primitive(which.part, which.place).distance(q);
          if (d <= v.reach(which.part)) v.offer(which.part, which.place, steps::id(which.part, which.place), d);
        }
      }
      __syncwarp();
    }

    candidates = 0;
    __syncwarp();
    limit();
  }
};

template <class Tally>
struct tangent_packet_memory : block_memory<Tally> {
  seen_memory seen[warps];
  lane_memory sharing;

  __device__ void clear() {
    sharing.clear();
    for (auto& s : seen) s.hint.part = none;
  }
};

template <class Tally>
struct tangent_packets : lone_search<Tally> {
  using lone = lone_search<Tally>;
  using sharing = lane_sharing<Tally>;
  static constexpr bool begins_anew = true;  ///< A warp that helps begins with nothing found.

  static __device__ bool receive(given_lanes& work) { return sharing::receive(work); }

  /// Searches for this lane's point `x`, in the cloud's frame, if it is `live`. `lanes` are those of this warp. The
  /// whole warp calls it. Returns the lanes that now have their answers; the rest are other warps'.
  template <class Visitor>
  static __device__ unsigned search(std::uint32_t packet, std::uint32_t index, unsigned lanes, bool live, vec3 x,
                                    Visitor& v) {
    unsigned left = __ballot_sync(all_lanes, live);
#pragma unroll 1
    while (left != 0) {
      if (__popc(left) >= worth_giving && sharing::asked()) {
        const unsigned half = half_of(left);
        if (sharing::give({packet, half})) {
          left &= ~half;
          lanes &= ~half;
        }
      }
      live = (left >> lone::lane() & 1) != 0;
      const unsigned later = left >> 16 << 16;  // the middle one of neighbours in a row, if it is left
      const vec3 middle = from_lane(x, later != 0 ? __ffs(int(later)) - 1 : 31 - __clz(int(left)));
      const real way = rough_length(x - middle), gap = lone::gap_to(middle);
      if (4 * __popc(__ballot_sync(all_lanes, live && way <= gap / 2)) < __popc(left)) {  // not neighbours
        v = lone::alone(live, x, v);
        break;
      }
      const bool near = live && way <= 0.02f + 0.1f * gap;
      tangent_walk<Tally, Visitor>::search(near, index, x, v);
      left &= ~__ballot_sync(all_lanes, near);
    }
    return lanes;
  }

 private:
  static constexpr int worth_giving = 8;  ///< Points.

  /// Half of some lanes, such that lanes of a tile or row stay together.
  static __device__ unsigned half_of(unsigned lanes) {
    const bool tile = frame_parts<Tally>::here().head.columns != 0;
    unsigned half = lanes & 0xffff0000;
    if (half == 0 || half == lanes) half = lanes & (tile ? 0xf0f0f0f0 : 0xff00ff00);
    if (half == 0 || half == lanes) half = lanes & (tile ? 0xff00ff00 : 0xf0f0f0f0);
    if (half == 0 || half == lanes) half = lanes & ~((1u << (31 - __clz(int(lanes)))) - 1);
    return half;
  }
};

}  // namespace clearance::scan
