// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The paper's alternative to moving points: the trees are moved into the cloud's frame before each frame's kernels.

#include "kernel.cuh"

namespace bench::paper {

template <bool Dummy = true>
__global__ void move_kernel(clearance::rigid_transform to, const clearance::sphere* volumes,
                            clearance::sphere* moved_volumes, unsigned nodes, const clearance::inner_sphere* primitives,
                            clearance::inner_sphere* moved_primitives, unsigned leaves) {
  const unsigned i = blockIdx.x * blockDim.x + threadIdx.x;
  if (i < nodes) moved_volumes[i] = moved(to, volumes[i]);
  if (i < leaves) moved_primitives[i] = moved(to, primitives[i]);
}

/// Memory for a second copy of every tree, and the kernels that fill it.
class moved_trees {
 public:
  using view = clearance::bvh_view<clearance::sphere, clearance::inner_sphere>;

  template <class Model>
  moved_trees(const Model& model, int device) {
    for (const auto& part : model.parts()) {
      volumes_.emplace_back(part.tree.volumes.size(), device);
      primitives_.emplace_back(part.tree.primitives.size(), device);
    }
  }

  /// The same parts with their trees in the cloud's frame; filled in the order of the default stream.
  parts_at<view> enqueue(const parts_at<view>& parts) const {
    parts_at<view> there = parts;
    for (unsigned k = 0; k < parts.count; ++k) {
      const auto& from = parts.part[k].tree;
      const auto nodes = unsigned(volumes_[k].size()), leaves = unsigned(primitives_[k].size());
      move_kernel<><<<(std::max(nodes, leaves) + 255) / 256, 256>>>(parts.part[k].cloud_from_part, from.volumes,
                                                                    volumes_[k].data(), nodes, from.primitives,
                                                                    primitives_[k].data(), leaves);
      check_cuda(cudaGetLastError(), "kernel launch");
      there.part[k].tree.volumes = volumes_[k].data(), there.part[k].tree.primitives = primitives_[k].data();
    }
    return there;
  }

 private:
  std::vector<clearance::device_buffer<clearance::sphere>> volumes_;
  std::vector<clearance::device_buffer<clearance::inner_sphere>> primitives_;
};

}  // namespace bench::paper
