// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/scan/arguments.hpp>
#include <clearance/scan/threads.cuh>

namespace clearance::scan {

/// Does what the host does with poses, for poses in memory that the device reads. One block; a thread has a part of
/// each group.
template <class PartView>
__global__ void __launch_bounds__(most_parts)
    place_kernel(const world_transform* world_from_part, const world_transform* world_from_cloud, const PartView* views,
                 std::uint32_t count, position_error off, placed_parts* groups) {
  __shared__ frames::frame_facts frame;
  const std::uint32_t t = threadIdx.x;
  const auto pose = [groups](std::uint32_t k) -> world_transform& {
    return groups[k / most_parts].world_from_part[k % most_parts];
  };
  bool rigid = true;
  for (std::uint32_t k = t; k < count; k += most_parts) {
    world_transform its = world_from_part[k];
    rigid = make_rigid(its) && rigid;
    pose(k) = its;
  }
  if (t == 0) {
    frame = {world_from_cloud == nullptr ? world_transform() : *world_from_cloud, {0, 0, 0}, off};
    rigid = make_rigid(frame.world_from_cloud) && rigid;
  }
  rigid = __syncthreads_and(rigid);
  if (t == 0 && rigid) frame.origin = frames::origin_near(frames::middle_of(frame.world_from_cloud, pose, count));
  __syncthreads();
  for (std::uint32_t k = t; k < count; k += most_parts)
    groups[k / most_parts].parts.part[t] =
        frame_part(frames::place(views[k].facts, pose(k), frame.world_from_cloud, frame.origin, off));
  __syncthreads();
  if (t == 0)
    for (std::uint32_t k = 0; k < count; ++k)
      frame.add(views[k].facts, groups[k / most_parts].parts.part[k % most_parts].error);
  __syncthreads();
  for (std::uint32_t first = 0, g = 0; first < count || g == 0; first += most_parts, ++g) {
    const std::uint32_t parts = lower_of(count - first, most_parts);
    if (t * cluster < parts) groups[g].parts.gather(t, parts);
    if (t == 0) groups[g].frame = frame, groups[g].rigid = rigid;
  }
}

}  // namespace clearance::scan
