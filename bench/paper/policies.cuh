// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The compiled axes of the paper's kernel: who shares the bound, how a group of lanes walks a tree, and how point and
// tree get into one frame.

#include "bounds.hpp"

#include <clearance/bvh/bvh.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/volume/sphere.hpp>

namespace bench::paper {

/// A part's tree and its place in the cloud's frame.
template <class View>
struct part_at {
  View tree;
  clearance::rigid_transform part_from_cloud, cloud_from_part;
  clearance::ball around;
};

// --- Sharing ------------------------------------------------------------------------------------------------------

struct shared_by_nobody {};
struct shared_by_block {};  ///< The paper's section 4.3: a minimum per block in shared memory, joined at the end.
struct shared_by_all {};    ///< The paper's Algorithm 3.

// --- Traversals: the library's, and one for groups of eight lanes ---------------------------------------------------

/// Eight lanes walk one tree with one point: each tests a child, or a primitive of a leaf; nearest child first. All
/// lanes of a group must call this together. Pending nodes are in dynamic shared memory, 64 entries per group.
struct cooperative {
  static constexpr unsigned lanes = 8;
  static constexpr unsigned entries = 64;
  struct entry {
    clearance::real bound;
    std::uint32_t node;
  };
  static std::size_t shared_bytes(unsigned threads) { return threads / lanes * entries * sizeof(entry); }

  template <clearance::hierarchy H>
  __device__ void operator()(const H& tree, clearance::vec3 p, word_bound& q) const {
    using traits = clearance::bounding_volume_traits<typename H::volume_type>;
    extern __shared__ entry pool[];
    entry* const pending = pool + threadIdx.x / lanes * entries;
    const unsigned lane = threadIdx.x % lanes, group = 0xffu << (threadIdx.x & 24);
    unsigned count = 1;
    if (lane == 0) pending[0] = {-clearance::infinity, tree.root()};  // its children decide
    __syncwarp(group);
    while (count > 0) {
      const entry top = pending[--count];
      const real reach = __shfl_sync(group, q.reach(), 0, lanes);  // one answer for all eight
      if (!(top.bound <= reach)) continue;
      const std::uint32_t size = tree.size(top.node);
      if (tree.is_leaf(top.node)) {
        real least = clearance::infinity;
        for (std::uint32_t k = lane; k < size; k += lanes)
          least = clearance::min(least, tree.primitive(top.node, k).distance(p));
        for (unsigned far = lanes / 2; far > 0; far /= 2)
          least = clearance::min(least, __shfl_xor_sync(group, least, far, lanes));
        if (lane == 0) q.offer(0, least);
      } else {
        real bound = clearance::infinity;
        if (lane < size) bound = traits::lower_bound(tree.volume(tree.child(top.node, lane)), p);
        const bool passes = lane < size && bound <= reach;
        unsigned at = count;  // one slot for each that passes and is farther
        for (unsigned k = 0; k < lanes; ++k) {
          const real other = __shfl_sync(group, passes ? bound : -clearance::infinity, k, lanes);
          at += other > bound || (other == bound && k > lane);
        }
        __syncwarp(group);  // all have read their top
        if (passes) pending[at] = {bound, tree.child(top.node, lane)};
        count += unsigned(__popc(__ballot_sync(group, passes) & group));
      }
      __syncwarp(group);
    }
  }
};

template <class Walk>
constexpr unsigned lanes_of() {
  if constexpr (requires { Walk::lanes; })
    return Walk::lanes;
  else
    return 1;
}

// --- Transforms ----------------------------------------------------------------------------------------------------

/// The paper's choice: each point into each part's frame.
struct points_into_parts {
  template <class View, class F>
  static CLEARANCE_HD void meet(const part_at<View>& part, clearance::vec3 p, real, F walk) {
    walk(part.tree, part.part_from_cloud(p));
  }
};

/// Ours: first a ball around the part in the cloud's frame; only survivors go into the part's frame.
struct survivors_into_parts {
  template <class View, class F>
  static CLEARANCE_HD void meet(const part_at<View>& part, clearance::vec3 p, real reach, F walk) {
    if (clearance::sphere{part.around.center, part.around.radius}.lower_bound(p) <= reach)
      walk(part.tree, part.part_from_cloud(p));
  }
};

/// The tree has been moved into the cloud's frame before (moved.cuh).
struct trees_beforehand {
  template <class View, class F>
  static CLEARANCE_HD void meet(const part_at<View>& part, clearance::vec3 p, real, F walk) {
    walk(part.tree, p);
  }
};

/// A volume and a primitive of a part, in the cloud's frame.
CLEARANCE_HD inline clearance::sphere moved(const clearance::rigid_transform& t, const clearance::sphere& s) {
  return {t(s.center), s.radius + 1e-6f};  // the float transform's error is smaller within a few metres
}
CLEARANCE_HD inline clearance::inner_sphere moved(const clearance::rigid_transform& t,
                                                  const clearance::inner_sphere& s) {
  return {t(s.center), s.radius};
}

/// What the paper calls extremely inefficient: moves each volume that is read to the point's frame.
struct volumes_in_walk {
  template <class H>
  struct moving : H {
    const clearance::rigid_transform* cloud_from_part;

    CLEARANCE_HD auto volume(typename H::node_type n) const { return moved(*cloud_from_part, H::volume(n)); }
    CLEARANCE_HD auto primitive(typename H::node_type n, std::uint32_t k) const {
      return moved(*cloud_from_part, H::primitive(n, k));
    }
  };

  template <class View, class F>
  static CLEARANCE_HD void meet(const part_at<View>& part, clearance::vec3 p, real, F walk) {
    walk(moving<View>{part.tree, &part.cloud_from_part}, p);
  }
};

}  // namespace bench::paper
