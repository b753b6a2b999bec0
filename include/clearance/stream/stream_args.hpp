// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What the one kernel of a frame is told, and what it leaves behind for the next frame.

#include <clearance/bvh_view.hpp>
#include <clearance/result.hpp>
#include <clearance/search/frame.hpp>
#include <clearance/search/root_test.hpp>

namespace clearance::stream {

inline constexpr std::uint32_t most_parts = 128;
inline constexpr std::uint32_t inline_parts = 12;  ///< As many as travel with the launch.
inline constexpr std::uint32_t most_children = 8;  ///< Of a node,
inline constexpr std::uint32_t deepest_stack = 64;  ///< and what a tree's depth-first stack may need; trees that `build` makes keep to both.
inline constexpr std::uint32_t no_bound = 0xff800000u;  ///< ordered(infinity)

/// A candidate for the answer: all that is needed to write it out, so that nobody has to search for it again.
struct record {
  distance_key key = no_key;
  std::uint32_t part = none;
  std::uint32_t id = none;         ///< The primitive's number in the user's array,
  std::uint32_t primitive = none;  ///< and its place in the tree (none: the point is inside, no primitive is known).
};

/// Lexicographic: distance, point, part, primitive.
CLEARANCE_HD inline bool before(const record& a, const record& b) {
  if (a.key != b.key) return a.key < b.key;
  if (a.part != b.part) return a.part < b.part;
  return a.id < b.id;
}

CLEARANCE_HD inline bool same(const record& a, const record& b) { return a.key == b.key && a.part == b.part && a.id == b.id; }

/// Lives in device memory from frame to frame; the last block of a frame resets all but the number of witnesses. Where all
/// parts share a bound, slot 0 is theirs; else each part has its own.
struct frame_state {
  std::uint32_t bound[most_parts];  ///< ordered() upper bounds of this frame, shared by all blocks.
  record best[most_parts];          ///< The minima over the clouds that are done,
  distance_key best_key = no_key;   ///< and over all blocks that are done, where all parts share a bound.
  std::uint32_t witnesses = 0;
  std::uint32_t done = 0;    ///< Blocks that have finished,
  std::uint32_t seeded = 0;  ///< and blocks that have seeded (cold frames only).
  unsigned long long dropped[drop_reasons] = {};
  unsigned long long certain = 0;

  frame_state() {
    for (auto& b : bound) b = no_bound;
  }
};

/// Where last frame's minimum was: this frame's first bound.
template <class Primitive>
struct witness {
  record r;
  Primitive primitive;
};

inline constexpr std::uint32_t cluster = 8;  ///< Parts that are first tested together, as one ball.
inline constexpr std::uint32_t most_clusters = most_parts / cluster;

/// Where one part is in one frame, as far as every block needs it.
struct alignas(16) frame_part {
  rigid_transform part_from_cloud;
  search::root_ball root;
  real error;
  real away;  ///< The farthest that its ball reaches from its cluster's centre.

  frame_part() = default;
  CLEARANCE_HD explicit frame_part(const search::placement& p) : part_from_cloud(p.part_from_cloud), root(p.around), error(p.error) {}
};

/// Some parts of a frame, and a ball around each eight of them.
template <std::uint32_t Most>
struct alignas(16) frame_parts_of {
  search::root_ball cluster[(Most + stream::cluster - 1) / stream::cluster];
  frame_part part[Most];

  /// Sets the ball around cluster c's parts, and what they need of it; there are `count` parts.
  CLEARANCE_HD void gather(std::uint32_t c, std::uint32_t count) {
    const std::uint32_t begin = c * stream::cluster, end = count < begin + stream::cluster ? count : begin + stream::cluster;
    vec3 low{infinity, infinity, infinity}, high = -low;
    for (std::uint32_t k = begin; k < end; ++k) {
      const vec3 at = part[k].root.around.center;
      low = {min(low.x, at.x), min(low.y, at.y), min(low.z, at.z)};
      high = {max(high.x, at.x), max(high.y, at.y), max(high.z, at.z)};
    }
    ball all{{(low.x + high.x) / 2, (low.y + high.y) / 2, (low.z + high.z) / 2}, 0};
    for (std::uint32_t k = begin; k < end; ++k) {
      const ball& b = part[k].root.around;
      part[k].away = (length(b.center - all.center) + b.radius) * (1 + 8 * slack);
      all.radius = max(all.radius, part[k].away);
    }
    cluster[c] = search::root_ball(all);
  }
};

/// In device memory: all parts, if poses live there and a kernel of its own has made them ready, or if there are too many
/// to travel with the launch.
struct placed_parts {
  search::frame_facts frame;
  bool rigid;
  frame_parts_of<most_parts> parts;
  world_transform world_from_part[most_parts];
};

/// What is asked of one cloud of a frame, in few words.
template <class PartView>
struct alignas(16) frame_head {
  using witness_type = witness<typename PartView::hierarchy_type::primitive_type>;

  std::uint32_t points, parts;
  std::uint32_t cloud, first;  ///< The cloud's number, and that of its first point among all clouds' points.
  std::uint32_t rounds;        ///< Until every point has been read by some block;
  std::uint32_t ahead;         ///< and how many of them are read a round ahead.
  std::uint32_t top_stride;    ///< First nodes of a tree that there is room for in shared memory.
  bool last;                   ///< No cloud follows: conclude.
  bool far;                    ///< All parts are in `rest`,
  bool placed;                 ///< and so is the frame.
  frame_state* state;
  witness_type* witnesses;
  record* records;           ///< Room for one a part and block, where each part has a bound;
  witness_type* candidates;  ///< else for one a block.
  const PartView* views;
  const placed_parts* rest;
};

template <class PartView>
using witness_of = typename frame_head<PartView>::witness_type;

/// One cloud of a frame; all but its points. What every block reads comes first and last what one block reads.
template <class PartView>
struct frame_args : frame_head<PartView> {
  using frame_head<PartView>::far;
  using frame_head<PartView>::placed;
  using frame_head<PartView>::rest;

  frame_parts_of<inline_parts> near;
  min_distance_result* result;
  part_minimum* minima;  ///< One a part, or null.
  std::uint32_t* done;   ///< Pinned, written after the result with `number`; or null.
  std::uint32_t number;
  search::frame_facts frame;
  world_transform world_from_part[inline_parts];

  CLEARANCE_HD const frame_part* part() const { return far ? rest->parts.part : near.part; }
  CLEARANCE_HD const search::root_ball* clusters() const { return far ? rest->parts.cluster : near.cluster; }
  CLEARANCE_HD const search::frame_facts& facts() const { return placed ? rest->frame : frame; }
};

}  // namespace clearance::stream
