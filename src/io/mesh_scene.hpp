// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// One mesh from a file's scene, which may place each of its meshes many times.

#include "io/mesh_polygons.hpp"

#include <clearance/io/error.hpp>
#include <clearance/io/limits.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

namespace clearance::io {

/// Joins all places of a scene graph's meshes into one mesh, within limits.
class mesh_scene {
 public:
  mesh_scene(const std::string& file, const mesh_limits& limits) : file_(file), limits_(limits) {}

  /// Adds a mesh at `here`. A mirroring transform turns the faces round, so that they still face out.
  void place(const polygon_mesh& mesh, const Eigen::Affine3d& here) {
    check(here);
    const std::size_t first = made_.vertices.size();
    if (made_.corners.size() + mesh.corners.size() > 3 * limits_.triangles ||
        first + mesh.vertices.size() > std::min<std::uint64_t>(3 * limits_.triangles, UINT32_MAX))
      refuse(file_, "with all its instances it has more than the " + std::to_string(limits_.triangles) +
                        " triangles that the limit leaves (mesh_limits::triangles)");
    for (const auto& v : mesh.vertices) {
      made_.vertices.push_back(here * v);
      if (!made_.vertices.back().allFinite()) refuse(file_, "its scene puts a vertex beyond what a number can hold");
    }
    const bool mirrored = here.linear().determinant() < 0;
    std::size_t begin = 0;
    for (const std::size_t end : mesh.ends) {
      for (std::size_t i = begin; i < end; ++i)
        made_.corners.push_back(std::uint32_t(first + mesh.corners[mirrored ? begin + end - 1 - i : i]));
      made_.ends.push_back(made_.corners.size());
      begin = end;
    }
  }

  /// Counts a node at this depth.
  void visit(std::size_t depth) {
    if (depth > limits_.depth)
      refuse(file_,
             "has more than " + std::to_string(limits_.depth) + " nodes inside one another (mesh_limits::depth)");
    if (++nodes_ > limits_.nodes)
      refuse(file_, "has more than " + std::to_string(limits_.nodes) +
                        " nodes, instances counted each time (mesh_limits::nodes)");
  }

  /// Counts what has to be looked at within a node, each time that the node has an instance.
  void look_at(std::size_t children) {
    looked_at_ += children;
    if (looked_at_ > limits_.values)
      refuse(file_, "has more than " + std::to_string(limits_.values) +
                        " elements in its nodes, instances counted each time (mesh_limits::values)");
  }

  polygon_mesh finish() { return std::move(made_); }

 private:
  void check(const Eigen::Affine3d& here) const {
    if (!here.matrix().allFinite()) refuse(file_, "a node's place is beyond what a number can hold");
    if (here.linear().determinant() == 0) refuse(file_, "a node flattens what is in it");
  }

  const std::string& file_;
  const mesh_limits& limits_;
  polygon_mesh made_;
  std::uint64_t nodes_ = 0, looked_at_ = 0;
};

}  // namespace clearance::io
