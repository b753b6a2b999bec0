// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Several lanes that go down a tree together.

#include <clearance/scan/descend.hpp>
#include <clearance/scan/steps.cuh>

namespace clearance::scan {

/// Some lanes of a warp. The whole warp stays together: groups that diverge would wait for one another.
template <std::uint32_t Size>
struct lanes {
  static constexpr std::uint32_t size = Size;
  __device__ std::uint32_t rank() const { return threadIdx.x % size; }
  __device__ bool any(bool mine) const { return __any_sync(all_lanes, mine); }
  __device__ real least(real mine) const {
    for (std::uint32_t step = 1; step < size; step *= 2) mine = min(mine, __shfl_xor_sync(all_lanes, mine, step));
    return mine;
  }
  __device__ int first(bool mine) const {
    const std::uint32_t first_lane = threadIdx.x & (32 - size);
    const unsigned those = __ballot_sync(all_lanes, mine) >> first_lane & ((1u << size) - 1);
    return those != 0 ? int(first_lane) + __ffs(int(those)) - 1 : -1;
  }
  __device__ bool is(int lane) const { return int(threadIdx.x & 31) == lane; }
  template <class T>
  __device__ T from(int lane, const T& mine) const {
    return from_lane(mine, lane < 0 ? int(threadIdx.x & 31) : lane);
  }
};
using eight_lanes = lanes<8>;

/// A part's tree as `descend` takes it.
template <class Tally>
struct steps_of_part {
  using all = tree_steps<Tally>;
  using node_type = typename all::node_type;
  using volume_type = typename Tally::hierarchy_type::volume_type;
  std::uint32_t part;

  __device__ node_type root() const { return all::root(part); }
  __device__ bool is_leaf(const node_type& n) const { return all::is_leaf(part, n); }
  __device__ std::uint32_t size(const node_type& n) const { return all::size(part, n); }
  __device__ auto child(const node_type& n, std::uint32_t j) const { return all::child(part, n, j); }
  __device__ real distance(const node_type& n, std::uint32_t j, vec3 q) const {
    return all::primitive(part, all::place_of(n, j)).distance(q);
  }
};

}  // namespace clearance::scan
