// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The paper's competitor with an octree over the cloud, after Pan et al. (2013): OctoMap's tree, whose leaves also hold
// their points. It skips cells farther from the robot's trees than the bound.

#if __has_include(<octomap/OccupancyOcTreeBase.h>)
#define CLEARANCE_BENCH_OCTOMAP
#include <clearance/frames/frame.hpp>
#include <clearance/robot/model.hpp>
#include <clearance/traversal/near_first.hpp>
#include <clearance/visitor/nearest.hpp>

#include <octomap/OcTreeNode.h>
#include <octomap/OccupancyOcTreeBase.h>

#include <bit>

namespace bench::paper {

class bucket_node : public octomap::OcTreeNode {
 public:
  std::vector<clearance::vec3> points;
};

class bucket_tree : public octomap::OccupancyOcTreeBase<bucket_node> {
 public:
  using OccupancyOcTreeBase::OccupancyOcTreeBase;
  bucket_tree* create() const override { return new bucket_tree(resolution); }
  std::string getTreeType() const override { return "bucket_tree"; }

  void insert(clearance::vec3 p) {
    if (bucket_node* const leaf = updateNode(octomap::point3d(p.x, p.y, p.z), true, true)) leaf->points.push_back(p);
  }
};

/// A cloud in an octree with cells of `cell` metres; coordinates are relative to the frame's origin.
template <class PartView>
class octree {
 public:
  template <clearance::point_source Source>
  octree(const Source& cloud, clearance::vec3 origin, double cell) : tree_(cell) {
    for (std::size_t i = 0; i < cloud.size(); ++i)
      if (const clearance::sample s = cloud[i]; s.valid()) tree_.insert(s.position - origin);
  }

  /// The least distance, visiting cells and children nearest first.
  clearance::real distance(clearance::model_view<PartView> model, const clearance::frames::cloud_frame& frame) {
    start(model, frame);
    visit(root(), [&](const bucket_node& leaf, std::uint64_t parts) { evaluate(leaf, parts); });
    return best_;
  }

  /// For each part the points that may be as near as a first greedy guess; the GPU tests these.
  std::vector<std::vector<clearance::vec3>> filtered(clearance::model_view<PartView> model,
                                                     const clearance::frames::cloud_frame& frame) {
    start(model, frame);
    greedy(root());
    std::vector<std::vector<clearance::vec3>> sets(model.size());
    visit(root(), [&](const bucket_node& leaf, std::uint64_t parts) {
      for (; parts != 0; parts &= parts - 1) {
        auto& set = sets[std::size_t(std::countr_zero(parts))];
        set.insert(set.end(), leaf.points.begin(), leaf.points.end());
      }
    });
    return sets;
  }

 private:
  using real = clearance::real;
  struct cell {
    const bucket_node* node = nullptr;
    clearance::vec3 center = {0, 0, 0};
    real half = 0;
    std::uint64_t parts = 0;  ///< The parts that it may be near enough to.
    real lower = 0;
  };

  void start(clearance::model_view<PartView> model, const clearance::frames::cloud_frame& frame) {
    model_ = model, frame_ = &frame, best_ = clearance::infinity;
  }

  cell root() const {
    return {tree_.getRoot(), {0, 0, 0}, real(tree_.getResolution() * 32768), ~std::uint64_t(0) >> (64 - model_.size())};
  }

  /// The existing children, nearest first, each with a lower bound and the parts that are near enough.
  int children(const cell& of, std::array<cell, 8>& out) const {
    int count = 0;
    for (unsigned i = 0; i < 8; ++i) {
      if (!tree_.nodeChildExists(of.node, i)) continue;
      const real h = of.half / 2;
      cell c{tree_.getNodeChild(of.node, i),
             {of.center.x + (i & 1 ? h : -h), of.center.y + (i & 2 ? h : -h), of.center.z + (i & 4 ? h : -h)},
             h,
             0,
             clearance::infinity};
      const real radius = 1.7320510f * h + 1e-5f;  // and possible rounding
      for (std::uint64_t left = of.parts; left != 0; left &= left - 1) {
        const auto k = std::size_t(std::countr_zero(left));
        clearance::nearest ask{.within = best_ + radius};
        clearance::near_first{}(model_.parts[k].tree, frame_->places[k].part_from_cloud(c.center), ask);
        if (ask.best == clearance::nearest::none) continue;
        c.parts |= std::uint64_t(1) << k, c.lower = std::min(c.lower, ask.within - radius);
      }
      if (c.parts == 0) continue;
      auto at = std::size_t(count++);
      for (; at > 0 && out[at - 1].lower > c.lower; --at) out[at] = out[at - 1];
      out[at] = c;
    }
    return count;
  }

  template <class Leaf>
  void visit(const cell& c, const Leaf& leaf) {
    if (!tree_.nodeHasChildren(c.node)) return leaf(*c.node, c.parts);
    std::array<cell, 8> next;
    const int count = children(c, next);
    for (int i = 0; i < count; ++i)
      if (next[std::size_t(i)].lower <= best_) visit(next[std::size_t(i)], leaf);
  }

  void greedy(cell c) {
    std::array<cell, 8> next;
    while (tree_.nodeHasChildren(c.node)) children(c, next), c = next[0];
    evaluate(*c.node, c.parts);
  }

  void evaluate(const bucket_node& leaf, std::uint64_t parts) {
    for (; parts != 0; parts &= parts - 1) {
      const auto k = std::size_t(std::countr_zero(parts));
      for (const clearance::vec3 p : leaf.points) {
        clearance::nearest ask{.within = best_};
        clearance::near_first{}(model_.parts[k].tree, frame_->places[k].part_from_cloud(p), ask);
        best_ = std::min(best_, ask.within);
      }
    }
  }

  bucket_tree tree_;
  clearance::model_view<PartView> model_ = {};
  const clearance::frames::cloud_frame* frame_ = nullptr;
  real best_ = clearance::infinity;
};

}  // namespace bench::paper
#endif
