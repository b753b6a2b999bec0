// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Packets for trees whose volumes and primitives know their tangents.

#include <clearance/scan/lane_sharing.cuh>
#include <clearance/scan/packets.cuh>
#include <clearance/scan/tangent_walk.cuh>

namespace clearance::scan {

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
        if (sharing::give({packet, half})) left &= ~half, lanes &= ~half;
      }
      live = (left >> lone::lane() & 1) != 0;
      const unsigned later = left >> 16 << 16;  // the middle one of neighbours in a row, if it is left
      const vec3 middle = from_lane(x, later != 0 ? __ffs(int(later)) - 1 : 31 - __clz(int(left)));
      const real way = rough_length(x - middle), gap = lone::gap_to(middle);
      if (4 * __popc(__ballot_sync(all_lanes, live && way <= gap / 2)) < __popc(left)) {  // not neighbours
        v = lone::alone(live, x, v);
        break;
      }
      const bool its = live && way <= 0.02f + 0.1f * gap;
      tangent_walk<Tally, Visitor>::search(its, index, x, v);
      left &= ~__ballot_sync(all_lanes, its);
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
