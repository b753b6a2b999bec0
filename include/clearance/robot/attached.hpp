// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Makes an object that a robot holds part of it, between two frames.

#include <clearance/robot/model.hpp>

namespace clearance {

/// A robot with an object on one of its links: the parts of both, the robot's first. Poses come in that order (an
/// object's is world-from-link * link-from-object). Only views are copied; robot and object must outlive it. To take
/// the object off, ask the robot itself again.
template <class PartView, class B = host>
class attached {
  static_assert(backend<B>);

 public:
  attached(const B& on, const model_view<PartView>& robot, const model_view<PartView>& object)
      : facts_(robot.facts.begin(), robot.facts.end()),
        depth_(std::max(robot.depth, object.depth)),
        width_(std::max(robot.width, object.width)) {
    facts_.insert(facts_.end(), object.facts.begin(), object.facts.end());
    std::vector<PartView> views = on.copy_out(robot.parts, robot.size());
    for (const PartView& its : on.copy_out(object.parts, object.size())) views.push_back(its);
    views_ = on.copy_in(std::span<const PartView>(views));
    if (robot.fields != nullptr && object.fields != nullptr)
      fields_ = on.copy_in(std::span<const field_view>(both(on, robot, robot.fields, object, object.fields)));
    if (robot.cells != nullptr || object.cells != nullptr)
      cells_ = on.copy_in(std::span<const cells_view>(both(on, robot, robot.cells, object, object.cells)));
  }

  std::size_t size() const { return facts_.size(); }
  model_view<PartView> view() const& CLEARANCE_LIFETIMEBOUND {
    return {views_.data(),
            facts_,
            depth_,
            width_,
            fields_.size() == 0 ? nullptr : fields_.data(),
            cells_.size() == 0 ? nullptr : cells_.data()};
  }
  model_view<PartView> view() const&& = delete;  // it would be gone when the view is read; give it a name

 private:
  /// Views of both robots' near maps; of null empty ones.
  template <class Map>
  static std::vector<Map> both(const B& on, const model_view<PartView>& robot, const Map* its,
                               const model_view<PartView>& object, const Map* of_object) {
    std::vector<Map> maps = its == nullptr ? std::vector<Map>(robot.size()) : on.copy_out(its, robot.size());
    const auto rest = of_object == nullptr ? std::vector<Map>(object.size()) : on.copy_out(of_object, object.size());
    maps.insert(maps.end(), rest.begin(), rest.end());
    return maps;
  }

  std::vector<part_facts> facts_;
  std::uint32_t depth_, width_;
  typename B::template buffer<PartView> views_;
  typename B::template buffer<field_view> fields_ = {};
  typename B::template buffer<cells_view> cells_ = {};
};

namespace detail {

/// Does a robot own what its part views look at? `attached` owns only the views, which are copied.
template <class R>
inline constexpr bool owns_parts = owning_robot<R>;
template <class PartView, class B>
inline constexpr bool owns_parts<attached<PartView, B>> = false;

}  // namespace detail

/// Both must be where `on` runs and have the same kind of part: spheres or meshes, with the same volume.
template <backend B, robot Robot, robot Object>
auto attach(const B& on, const Robot& robot, const Object& object) {
  using part = typename decltype(view_of(robot))::part_type;
  static_assert(
      std::is_same_v<part, typename decltype(view_of(object))::part_type>,
      "what is attached has to be of the same kind of part as the robot: the same primitives, volumes and interior");
  return attached<part, B>(on, view_of(robot), view_of(object));
}

// A temporary robot or object would be gone when the answer is asked; give it a name.

template <backend B, robot Robot, robot Object>
  requires(detail::owns_parts<Robot>)
void attach(const B&, const Robot&&, const Object&) = delete;
template <backend B, robot Robot, robot Object>
  requires(detail::owns_parts<Object>)
void attach(const B&, const Robot&, const Object&&) = delete;
template <backend B, robot Robot, robot Object>
  requires(detail::owns_parts<Robot> || detail::owns_parts<Object>)
void attach(const B&, const Robot&&, const Object&&) = delete;

}  // namespace clearance
