// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What the one kernel of a frame is told, and what it leaves behind for the next frame.

#include <clearance/bvh_view.hpp>
#include <clearance/result.hpp>
#include <clearance/search/frame.hpp>

namespace clearance::stream {

inline constexpr std::uint32_t most_parts = 128;
inline constexpr std::uint32_t inline_parts = 12;  ///< As many as fit into 4 kB of kernel arguments.
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

/// One part for one frame.
template <class PartView>
struct alignas(16) stream_part {
  search::placement place;
  bvh_node root;
  PartView view;
  vec3 middle;  ///< Of its cluster's centres, in the cloud's frame,
  real away;    ///< and the farthest that its ball reaches from there.
};

inline constexpr std::uint32_t cluster = 8;  ///< Parts that are first tested together, as one ball.

/// Sets `middle` and `away` of one cluster's parts.
template <class PartView>
CLEARANCE_HD void gather(stream_part<PartView>* parts, std::uint32_t count) {
  vec3 low{infinity, infinity, infinity}, high = -low;
  for (std::uint32_t k = 0; k < count; ++k) {
    const vec3 at = parts[k].place.around.center;
    low = {min(low.x, at.x), min(low.y, at.y), min(low.z, at.z)};
    high = {max(high.x, at.x), max(high.y, at.y), max(high.z, at.z)};
  }
  const vec3 middle{(low.x + high.x) / 2, (low.y + high.y) / 2, (low.z + high.z) / 2};
  for (std::uint32_t k = 0; k < count; ++k) {
    const ball& b = parts[k].place.around;
    parts[k].middle = middle, parts[k].away = (length(b.center - middle) + b.radius) * (1 + 8 * slack);
  }
}

/// Poses that live on the device, made ready by a kernel of their own.
template <class PartView>
struct placed_parts {
  search::frame_facts frame;
  bool rigid;
  stream_part<PartView> part[most_parts];
};

/// One cloud of a frame; all but its points.
template <class PartView>
struct frame_args {
  std::uint32_t points, parts;
  std::uint32_t cloud, first;  ///< The cloud's number, and that of its first point among all clouds' points.
  bool last;                   ///< No cloud follows: conclude.
  bool ring;                   ///< There is shared memory for points on their way.
  frame_state* state;
  record* records;  ///< Room for one a block and slot.
  min_distance_result* result;
  part_minimum* minima;  ///< One a part, or null.
  std::uint32_t* done;   ///< Pinned, written after the result with `number`; or null.
  std::uint32_t number;
  const placed_parts<PartView>* placed;  ///< If not null, what follows is there and not here.
  search::frame_facts frame;
  const stream_part<PartView>* more;  ///< Parts from inline_parts on.
  stream_part<PartView> part[inline_parts];
};

}  // namespace clearance::stream
