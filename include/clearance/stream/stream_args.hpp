// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What the one kernel of a frame is told, and what it leaves behind for the next frame.

#include <clearance/bvh_view.hpp>
#include <clearance/result.hpp>
#include <clearance/search/frame.hpp>

namespace clearance::stream {

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

/// Lives in device memory from frame to frame; the last block of a frame resets all but the witnesses.
struct frame_state {
  static constexpr std::uint32_t kept = 32;

  std::uint32_t bound = 0xff800000u;  ///< ordered() upper bound of this frame, shared by all blocks.
  std::uint32_t done = 0;             ///< Blocks that have finished,
  std::uint32_t seeded = 0;           ///< blocks that have seeded (cold frames only),
  std::uint32_t records = 0;          ///< and blocks with a candidate.
  unsigned long long dropped[drop_reasons] = {};
  unsigned long long certain = 0;
  std::uint32_t witnesses = 0;
  record witness[kept];  ///< Where last frame's minima were: this frame's first bound.
};

/// One part for one frame.
template <class PartView>
struct stream_part {
  search::placement place;
  bvh_node root;
  PartView view;
};

inline constexpr std::uint32_t inline_parts = 12;  ///< As many as fit into 4 kB of kernel arguments.

/// All but the points.
template <class PartView>
struct frame_args {
  vec3 origin;
  std::uint32_t points, parts;
  double error;  ///< The largest `placement::error`,
  double slop;   ///< and the largest gap plus tolerance.
  frame_state* state;
  record* records;  ///< Room for one a block.
  min_distance_result* result;
  std::uint32_t* done;  ///< Pinned, written after the result with `frame`; or null.
  std::uint32_t frame;
  world_transform world_from_cloud;
  const stream_part<PartView>* more;  ///< Parts from inline_parts on.
  stream_part<PartView> part[inline_parts];
};

}  // namespace clearance::stream
