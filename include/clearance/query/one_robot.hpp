// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The arguments of a question as an engine takes them.

#include <clearance/backend/plain.hpp>
#include <clearance/frame/clouds.hpp>
#include <clearance/robot/model.hpp>

#include <optional>

namespace clearance::detail {

/// A robot where one backend runs. A part alone becomes a robot of one part, in memory that this keeps.
template <class On, class PartView>
class one_robot {
 public:
  template <robot Robot>
  one_robot(const On&, const Robot& robot) : view_(view_of(robot)) {}

  template <rigid_part Part>
  one_robot(const On& on, const Part& part) : view_{nullptr, {&part.facts, 1}, 0, 0} {
    const PartView its = part.view();
    check(part.facts, 0);
    own_.emplace(backend_of(on).copy_in(std::span(&its, 1)));
    view_ = {own_->data(), view_.facts, its.tree.depth(), its.tree.width()};
  }

  const model_view<PartView>& view() const { return view_; }

 private:
  model_view<PartView> view_;
  std::optional<typename backend_of_t<On>::template buffer<PartView>> own_;
};

/// What is known of a robot's parts.
template <class Robot>
std::span<const part_facts> facts_of(const Robot& robot) {
  if constexpr (rigid_part<Robot>)
    return {&robot.facts, 1};
  else
    return view_of(robot).facts;
}

/// Poses as they may be given: one per part, or for a part its pose.
template <class Poses>
std::span<const Eigen::Isometry3d> as_poses(const Poses& poses) {
  if constexpr (std::is_same_v<Poses, Eigen::Isometry3d>) {
    return {&poses, 1};
  } else {
    static_assert(std::is_convertible_v<const Poses&, std::span<const Eigen::Isometry3d>>,
                  "poses are Eigen::Isometry3d, world-from-part, one per part: a vector, an array or a span of them; "
                  "or one, for one part");
    return poses;
  }
}

}  // namespace clearance::detail
