// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A picture of packings for any glTF viewer: spheres in the transparent mesh, and the levels of their tree.

#include <clearance/io/scene.hpp>
#include <clearance/packing/packing.hpp>

#include <string>
#include <vector>

namespace clearance::io {

struct scene_packing {
  std::string name;
  triangle_mesh mesh;  // in the part's frame
  packing spheres;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  // world-from-part
};

/// The volumes of a tree by level, starting at the root.
template <class View>
std::vector<std::vector<ball>> levels_of(const View& tree) {
  std::vector<std::vector<ball>> levels(tree.depth() + 1);
  const auto visit = [&](const auto& self, auto node, std::size_t level) -> void {
    const auto& around = tree.volume(node);
    levels[level].push_back({around.center, around.radius});
    if (tree.is_leaf(node)) return;
    for (std::uint32_t k = 0; k < tree.size(node); ++k) self(self, tree.child(node, k), level + 1);
  };
  visit(visit, tree.root(), 0);
  return levels;
}

/// Makes one node per part, with the part's name. In it are nodes that a viewer can switch on and off: "mesh",
/// transparent; "spheres", one node per octave of radii; and one per level of the tree that a query walks (Weller &
/// Zachmann 2009, figure 2).
scene packing_scene(const std::vector<scene_packing>& parts);

}  // namespace clearance::io
