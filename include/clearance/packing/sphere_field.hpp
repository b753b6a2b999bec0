// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/solid/box_tree.hpp>

namespace clearance {

/// Distances to a growing set of spheres, in double: a tree over most of them, and a short list of the newest.
class sphere_field {
 public:
  struct sphere {
    Eigen::Vector3d center;
    double radius;
    double distance(const Eigen::Vector3d& p) const { return (p - center).norm() - radius; }
  };

  sphere_field() = default;
  explicit sphere_field(std::span<const inner_sphere> spheres) {
    for (const inner_sphere& s : spheres) spheres_.push_back({{s.center.x, s.center.y, s.center.z}, s.radius});
    build();
  }

  std::size_t size() const { return spheres_.size(); }
  const sphere& operator[](std::size_t i) const { return spheres_[i]; }

  void insert(const sphere& s) {
    spheres_.push_back(s);
    if (spheres_.size() - tree_.size() > 32 + tree_.size() / 8) build();
  }

  /// The least distance if it is below `within`, else `within`. Inside a sphere: some negative distance.
  double distance(const Eigen::Vector3d& p, double within) const {
    const double best = tree_.nearest(p, within, [&](std::uint32_t i, double b) { return std::min(b, spheres_[i].distance(p)); });
    return distance_from(tree_.size(), p, best);
  }
  /// The same, of the spheres from number `first` on: one after another.
  double distance_from(std::size_t first, const Eigen::Vector3d& p, double within) const {
    for (std::size_t i = first; i < spheres_.size(); ++i) within = std::min(within, spheres_[i].distance(p));
    return within;
  }
  /// Whichever is quicker for a cell that has seen the first `seen`.
  double update(std::size_t seen, const Eigen::Vector3d& p, double within) const {
    return spheres_.size() - seen <= 64 ? distance_from(seen, p, within) : distance(p, within);
  }

  /// Numbers of the spheres closer than `reach`.
  std::vector<std::uint32_t> within(const Eigen::Vector3d& p, double reach) const {
    std::vector<std::uint32_t> some;
    const auto take = [&](std::uint32_t i) {
      if (spheres_[i].distance(p) < reach) some.push_back(i);
    };
    tree_.within(p, reach, take);
    for (std::size_t i = tree_.size(); i < spheres_.size(); ++i) take(std::uint32_t(i));
    return some;
  }

 private:
  void build() {
    std::vector<Eigen::AlignedBox3d> boxes;
    boxes.reserve(spheres_.size());
    for (const sphere& s : spheres_)
      boxes.emplace_back(s.center - Eigen::Vector3d::Constant(s.radius), s.center + Eigen::Vector3d::Constant(s.radius));
    tree_ = box_tree(boxes);
  }

  std::vector<sphere> spheres_;
  box_tree tree_;
};

}  // namespace clearance
