// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/packing/growing.hpp>
#include <clearance/packing/room_view.hpp>
#include <clearance/solid/box_tree.hpp>

namespace clearance {

/// A growing list of spheres, here and in B's memory, and a tree over most of them.
template <backend B>
class spheres_there {
 public:
  explicit spheres_there(const B& on) : on_(on), there_(on), nodes_(on), order_(on) {}

  std::size_t size() const { return here_.size(); }
  const std::vector<solid_sphere>& here() const { return here_; }

  template <solid_view V>
  room_view<V> room_in(const V& solid) {
    return {solid,
            there_.data(),
            std::uint32_t(size()),
            {nodes_.data(), order_.data(), tree_.view().items, tree_.view().root}};
  }

  /// Where `n` more can be written in B's memory; `add` makes them count.
  solid_sphere* reserve(std::size_t n) { return there_.reserve(size() + n, size()) + size(); }
  void add(std::span<const solid_sphere> written) { here_.insert(here_.end(), written.begin(), written.end()); }
  void insert(std::span<const solid_sphere> some) {
    on_.stage(some, reserve(some.size()));
    add(some);
  }

  /// Builds the tree anew once more than `most` spheres are not in it.
  void plant(std::size_t most) {
    if (size() - tree_.size() <= most) return;
    std::vector<Eigen::AlignedBox3d> boxes;
    boxes.reserve(size());
    for (const solid_sphere& s : here_) {
      const Eigen::Vector3d c = s.center, r = Eigen::Vector3d::Constant(s.radius);
      boxes.emplace_back(c - r, c + r);
    }
    tree_ = box_tree(boxes);
    on_.stage(tree_.nodes(), nodes_.reserve(tree_.nodes().size()));
    on_.stage(tree_.order(), order_.reserve(tree_.order().size()));
  }

 private:
  B on_;
  std::vector<solid_sphere> here_;
  growing<solid_sphere, B> there_;
  box_tree tree_;
  growing<box_pair, B> nodes_;
  growing<std::uint32_t, B> order_;
};

}  // namespace clearance
