// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The arguments of a scan's kernel.

#include <clearance/frames/frame.hpp>
#include <clearance/frames/root_test.hpp>
#include <clearance/ground/ordered.hpp>
#include <clearance/result.hpp>

namespace clearance::scan {

// What a walk on a device finds.

/// A primitive near a point, with all that names it, so that it need not be searched for again.
template <class Place>
struct record {
  distance_key key = no_key;
  std::uint32_t part = none;
  std::uint32_t id = none;  ///< The primitive's number in the user's array; none: the point is inside, none is known.
  Place place = {};         ///< Where in the tree the primitive is.
};

/// Lexicographic: distance, point, part, primitive.
template <class Place>
CLEARANCE_HD bool before(const record<Place>& a, const record<Place>& b) {
  if (a.key != b.key) return a.key < b.key;
  if (a.part != b.part) return b.part > a.part;  // a `<` after a dependent `part` would begin the template of that name
  return a.id < b.id;
}

template <class Place>
CLEARANCE_HD bool same(const record<Place>& a, const record<Place>& b) {
  return a.key == b.key && a.part == b.part && a.id == b.id;
}

inline constexpr std::uint32_t most_parts = 128;    ///< Parts in one kernel.
inline constexpr std::uint32_t inline_parts = 12;   ///< How many parts travel with the launch.
inline constexpr std::uint32_t most_children = 8;   ///< Children of a node of a tree from `build`.
inline constexpr std::uint32_t deepest_stack = 64;  ///< Entries of the depth-first stack of a tree from `build`.
inline constexpr std::uint32_t most_width = most_children << 15;  ///< Children of a node of any other tree.
inline constexpr std::uint32_t cluster = 8;  ///< Parts that are first tested together, as one ball.
inline constexpr std::uint32_t most_clusters = most_parts / cluster;
inline constexpr std::uint32_t no_bound = 0xff800000u;  ///< ordered(infinity): no bound is known.

/// Lives in device memory from scan to scan. The last block of a scan resets it.
struct scan_state {
  std::uint32_t done = 0;   ///< Blocks that have finished.
  std::uint32_t taken = 0;  ///< Batches that warps have asked for, beyond their first.
  unsigned long long dropped[drop_reasons] = {};
};

/// What every block needs about where one part is in a frame.
struct alignas(16) frame_part {
  rigid_transform part_from_cloud;
  frames::root_ball root;
  real error;
  real away;  ///< How far its ball reaches from its cluster's centre.

  frame_part() = default;
  CLEARANCE_HD explicit frame_part(const frames::placement& p)
      : part_from_cloud(p.part_from_cloud), root(p.around), error(p.error) {}
};

/// Some parts of a frame, and a ball around every eight of them.
template <std::uint32_t Most>
struct alignas(16) frame_parts_of {
  frames::root_ball cluster[(Most + scan::cluster - 1) / scan::cluster];
  frame_part part[Most];

  /// Sets the ball around cluster c's parts and their `away`. There are `count` parts in all.
  CLEARANCE_HD void gather(std::uint32_t c, std::uint32_t count) {
    const std::uint32_t begin = c * scan::cluster, end = count < begin + scan::cluster ? count : begin + scan::cluster;
    vec3 low{infinity, infinity, infinity}, high = -low;
    for (std::uint32_t k = begin; k < end; ++k) {
      const vec3 at = part[k].root.around.center;
      low = {min(low.x, at.x), min(low.y, at.y), min(low.z, at.z)};
      high = {max(high.x, at.x), max(high.y, at.y), max(high.z, at.z)};
    }
    ball around{{(low.x + high.x) / 2, (low.y + high.y) / 2, (low.z + high.z) / 2}, 0};
    for (std::uint32_t k = begin; k < end; ++k) {
      const ball& b = part[k].root.around;
      part[k].away = (length(b.center - around.center) + b.radius) * (1 + 8 * slack);
      around.radius = max(around.radius, part[k].away);
    }
    cluster[c] = frames::root_ball(around);
  }
};

/// All parts, in device memory. Used if poses live there and a kernel prepares them, or if they are too many to travel
/// with the launch.
struct placed_parts {
  frames::frame_facts frame;
  bool rigid;
  frame_parts_of<most_parts> parts;
  world_transform world_from_part[most_parts];
};

/// What every block keeps about one cloud. `Tally` is what a block keeps of an answer (concepts/block_tally.cuh), such
/// as `minimum::least`.
template <class Tally>
struct alignas(16) scan_head {
  using part_type = typename Tally::part_type;

  std::uint32_t points, parts;
  std::uint32_t cloud, first;   ///< The cloud's number, and that of its first point among all clouds' points.
  std::uint32_t rounds;         ///< Rounds until some block has read every point.
  std::uint32_t ahead;          ///< How many rounds are read a round ahead.
  std::uint32_t top_stride;     ///< How many first nodes of each tree shared memory has room for.
  bool last;                    ///< No cloud follows: conclude.
  bool far;                     ///< All parts are in `rest`.
  bool placed;                  ///< The frame is in `rest`.
  std::uint32_t columns;        ///< Columns of an image whose tiles are packets; or 0.
  std::uint32_t overflow_room;  ///< Entries in `overflow` for each warp, and after those for each block.
  std::byte* overflow;          ///< Stacks for trees that are too deep or wide for shared memory; or null.
  scan_state* state;
  const part_type* views;
  const placed_parts* rest;
  typename Tally::arguments answer;
};

/// All arguments but the points. What every block reads comes first; what one block reads comes last.
template <class Tally>
struct scan_arguments : scan_head<Tally> {
  using scan_head<Tally>::far;
  using scan_head<Tally>::placed;
  using scan_head<Tally>::rest;

  frame_parts_of<inline_parts> near;
  std::uint32_t* done;  ///< Pinned, written after the result with `number`; or null.
  std::uint32_t number;
  frames::frame_facts frame;
  world_transform world_from_part[inline_parts];

  CLEARANCE_HD const frame_part* part() const { return far ? rest->parts.part : near.part; }
  CLEARANCE_HD const frames::root_ball* clusters() const { return far ? rest->parts.cluster : near.cluster; }
  CLEARANCE_HD const frames::frame_facts& facts() const { return placed ? rest->frame : frame; }
  CLEARANCE_HD world_transform pose(std::uint32_t k) const {
    return far ? rest->world_from_part[k] : world_from_part[k];
  }
};

}  // namespace clearance::scan
