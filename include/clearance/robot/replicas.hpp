// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A robot with a copy on each of several backends.

#include <clearance/robot/model.hpp>

namespace clearance {

/// What an operation on several backends takes as a robot: a view in the memory of each.
template <class PartView>
struct replicas_view {
  using part_type = PartView;

  std::span<const model_view<PartView>> each;
  std::span<const part_facts> facts;

  std::size_t size() const { return facts.size(); }
  replicas_view view() const { return *this; }
};

/// Owns the copies that `model::on` makes.
template <class Model>
class replicas {
 public:
  using view_type = typename Model::view_type;

  explicit replicas(std::vector<Model> each) : each_(std::move(each)) {
    for (const Model& m : each_) views_.push_back(m.view());
  }
  /// A copy has views of its own models.
  replicas(const replicas& other)
    requires std::copy_constructible<Model>
      : replicas(other.each_) {}
  replicas(replicas&&) = default;
  replicas& operator=(replicas other) {
    std::swap(each_, other.each_);
    std::swap(views_, other.views_);
    return *this;
  }

  std::size_t size() const { return each_[0].size(); }
  const std::vector<Model>& each() const { return each_; }
  replicas_view<view_type> view() const& CLEARANCE_LIFETIMEBOUND { return {views_, views_[0].facts}; }
  replicas_view<view_type> view() const&& = delete;  // the copies would be gone when the view is read; name them

 private:
  std::vector<Model> each_;
  std::vector<model_view<view_type>> views_;
};

}  // namespace clearance
