// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/stream/stream_args.hpp>

namespace clearance::stream {

/// What the host does with poses, for poses in memory that the device reads: a thread a part, one block.
template <class PartView>
__global__ void __launch_bounds__(most_parts) place_kernel(const world_transform* world_from_part, const world_transform* world_from_cloud,
                                                           const PartView* views, std::uint32_t count, position_error off, placed_parts* out) {
  __shared__ world_transform pose[most_parts];
  __shared__ search::placement place[most_parts];
  __shared__ search::frame_facts frame;
  const std::uint32_t t = threadIdx.x;
  bool rigid = true;
  if (t < count) pose[t] = world_from_part[t], rigid = make_rigid(pose[t]);
  if (t == 0) {
    frame = {world_from_cloud == nullptr ? world_transform() : *world_from_cloud, {0, 0, 0}, off};
    rigid = make_rigid(frame.world_from_cloud) && rigid;
  }
  rigid = __syncthreads_and(rigid);
  if (t == 0 && rigid) frame.origin = search::origin_near(search::middle_of(frame.world_from_cloud, pose, count));
  __syncthreads();
  if (t < count) {
    place[t] = search::place(views[t].facts, pose[t], frame.world_from_cloud, frame.origin, off);
    out->parts.part[t] = frame_part(place[t]);
    out->world_from_part[t] = pose[t];
  }
  __syncthreads();
  if (t * cluster < count) out->parts.gather(t, count);
  if (t != 0) return;
  for (std::uint32_t k = 0; k < count; ++k) frame.add(views[k].facts, place[k]);
  out->frame = frame, out->rigid = rigid;
}

}  // namespace clearance::stream
