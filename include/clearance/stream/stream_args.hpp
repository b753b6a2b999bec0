// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What the one kernel of a frame is told, and what it leaves behind for the next frame.

#include <clearance/bvh_view.hpp>
#include <clearance/result.hpp>
#include <clearance/search/frame.hpp>

namespace clearance::stream {

inline constexpr std::uint32_t most_parts = 128;
inline constexpr std::uint32_t inline_parts = 12;  ///< As many as travel with the launch.
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

/// Lives in device memory from frame to frame; the last block of a frame resets all but the witnesses. Where all parts
/// share a bound, slot 0 is theirs; else each part has its own.
struct frame_state {
  std::uint32_t bound[most_parts];  ///< ordered() upper bounds of this frame, shared by all blocks.
  record best[most_parts];          ///< The minima over the clouds that are done.
  record witness[most_parts];       ///< Where last frame's minima were: this frame's first bounds.
  std::uint32_t witnesses = 0;
  std::uint32_t done = 0;    ///< Blocks that have finished,
  std::uint32_t seeded = 0;  ///< and blocks that have seeded (cold frames only).
  unsigned long long dropped[drop_reasons] = {};
  unsigned long long certain = 0;

  frame_state() {
    for (auto& b : bound) b = no_bound;
  }
};

inline constexpr std::uint32_t cluster = 8;  ///< Parts that are first tested together, as one ball.

/// Where one part is in one frame, as far as every block needs it.
struct alignas(16) frame_part {
  rigid_transform part_from_cloud;
  ball around;
  real error;
  real away;    ///< The farthest that its ball reaches
  vec3 middle;  ///< from the middle of its cluster's centres, in the cloud's frame.

  frame_part() = default;
  CLEARANCE_HD explicit frame_part(const search::placement& p) : part_from_cloud(p.part_from_cloud), around(p.around), error(p.error) {}
};

/// Sets `middle` and `away` of one cluster's parts.
CLEARANCE_HD inline void gather(frame_part* parts, std::uint32_t count) {
  vec3 low{infinity, infinity, infinity}, high = -low;
  for (std::uint32_t k = 0; k < count; ++k) {
    const vec3 at = parts[k].around.center;
    low = {min(low.x, at.x), min(low.y, at.y), min(low.z, at.z)};
    high = {max(high.x, at.x), max(high.y, at.y), max(high.z, at.z)};
  }
  const vec3 middle{(low.x + high.x) / 2, (low.y + high.y) / 2, (low.z + high.z) / 2};
  for (std::uint32_t k = 0; k < count; ++k) {
    const ball& b = parts[k].around;
    parts[k].middle = middle, parts[k].away = (length(b.center - middle) + b.radius) * (1 + 8 * slack);
  }
}

/// In device memory: all parts, if poses live there and a kernel of its own has made them ready; else those from
/// inline_parts on.
struct placed_parts {
  search::frame_facts frame;
  bool rigid;
  frame_part part[most_parts];
  world_transform world_from_part[most_parts];
};

/// What is asked of one cloud of a frame, in few words.
template <class PartView>
struct alignas(16) frame_head {
  std::uint32_t points, parts;
  std::uint32_t cloud, first;  ///< The cloud's number, and that of its first point among all clouds' points.
  bool last;                   ///< No cloud follows: conclude.
  bool ring;                   ///< There is shared memory for points on their way.
  bool placed;                 ///< All parts are in `rest`, and so is the frame.
  frame_state* state;
  record* records;  ///< Room for one a slot and block.
  const PartView* views;
  const placed_parts* rest;
};

/// One cloud of a frame; all but its points. What every block reads comes first and last what one block reads.
template <class PartView>
struct frame_args : frame_head<PartView> {
  using frame_head<PartView>::placed;
  using frame_head<PartView>::rest;

  frame_part part[inline_parts];
  min_distance_result* result;
  part_minimum* minima;  ///< One a part, or null.
  std::uint32_t* done;   ///< Pinned, written after the result with `number`; or null.
  std::uint32_t number;
  search::frame_facts frame;
  world_transform world_from_part[inline_parts];

  CLEARANCE_HD const search::frame_facts& facts() const { return placed ? rest->frame : frame; }
  CLEARANCE_HD const world_transform& world(std::uint32_t k) const {
    return placed || k >= inline_parts ? rest->world_from_part[k] : world_from_part[k];
  }
};

}  // namespace clearance::stream
