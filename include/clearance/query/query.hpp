// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Asks any question: once, or prepared for every frame.

#include <clearance/backend/one_call.hpp>
#include <clearance/pairwise/engine.hpp>
#include <clearance/query/callable.hpp>

namespace clearance {

namespace detail {

/// What answers a question on one backend: its own engine, or the one for questions about pairs.
template <class Q, class On, class PartView>
struct engine_of {
  using type = pairwise::engine<Q, On, PartView>;
};
template <class Q, class On, class PartView>
  requires requires { typename Q::template engine<On, PartView>; }
struct engine_of<Q, On, PartView> {
  using type = typename Q::template engine<On, PartView>;
};

/// Where a backend writes, for a question that can be enqueued so.
struct nowhere {
  nowhere() = delete;
};
template <class Q>
struct out_of {
  using type = nowhere;
};
template <class Q>
  requires requires { typename Q::out; }
struct out_of<Q> {
  using type = typename Q::out;
};

/// Is there a scan for this backend? <clearance/device.cuh> says so for devices.
template <class On>
inline constexpr bool has_scan = !requires { typename On::own_scan; };

/// What is asked, and of whom, with reasons; before anything else is looked at.
template <class On, class Robot, class Q>
consteval bool explain_asked() {
  constexpr bool known = backend<On> || requires { typename On::several; } || requires(const On on) { on.on, on.walk; };
  static_assert(known, "the first argument is a backend: host{}, device{}, devices{...}, or plain{backend, traversal}");
  static_assert(!known || has_scan<On>, "a device is asked with nvcc: include <clearance/device.cuh>");
  return known && has_scan<On> && explain_robot<Robot>() && explain_question<Q>();
}

}  // namespace detail

/// A prepared question: make it once for a robot, and ask it in every frame with new poses and points, or with other
/// options. It keeps its memory. What it remembers of the last frame only makes it faster. Use one object from one
/// stream and one thread (two at once: a debug build throws std::logic_error); the robot must outlive it. On a device,
/// `memory` may be a std::pmr::memory_resource* that hands out device memory.
template <question Q, class On, class PartView>
class query : detail::one_robot<On, PartView>,
              public detail::engine_of<Q, On, PartView>::type,
              public detail::callable<query<Q, On, PartView>, Q> {
  using robot_type = detail::one_robot<On, PartView>;
  using callable = detail::callable<query, Q>;
  using engine = typename detail::engine_of<Q, On, PartView>::type;
  using out = typename detail::out_of<Q>::type;

 public:
  template <class Robot, class... Memory>
  query(const On& on, const Robot& robot, const Q& asked, Memory... memory)
      : robot_type(on, robot), engine(on, robot_type::view(), memory...), callable(asked) {
    static_assert(detail::explain_asked<On, Robot, Q>());
  }

  /// Enqueues a frame and does not wait. Clouds must be readable where it runs; they, and all that `to` names, must
  /// stay until it is done. On a device, a graph that captures this keeps the current poses and options.
  template <class Poses, class Clouds>
  auto enqueue(const Poses& poses, const Clouds& clouds, const Q& q, const out& to) {
    static_assert(explain_given<Clouds>());
    const detail::in_use::call only(callable::used());
    return engine::start(detail::as_poses(poses), clouds, q, to);
  }
  template <class Poses, class Clouds>
  auto enqueue(const Poses& poses, const Clouds& clouds, const out& to) {
    return enqueue(poses, clouds, callable::asked(), to);
  }
  /// The same with poses in device or pinned memory: one per part, and the cloud's (null: the world's). A graph that
  /// captures this sees the memory of each launch.
  template <point_source S>
  void enqueue(const world_transform* poses, const S& source, const world_transform* cloud_pose, const out& to) {
    const detail::in_use::call only(callable::used());
    engine::start_with(poses, source, cloud_pose, to);
  }
  /// About placed configurations: returns device memory with one result per configuration.
  template <class Clouds>
  auto enqueue(const Clouds& clouds, const Q& q) {
    const detail::in_use::call only(callable::used());
    return engine::start_placed(clouds, q);
  }
  template <class Clouds>
  auto enqueue(const Clouds& clouds) {
    return enqueue(clouds, callable::asked());
  }

  std::span<const part_facts> facts() const { return robot_type::view().facts; }
};
template <class On, class Robot, class Q, class... Memory>
query(const On&, const Robot&, const Q&, Memory...) -> query<Q, On, typename detail::part_view_of<Robot>::type>;

/// Asks once. The arguments are those of a `query` and of its call.
template <class On, class Robot, class Poses, class Clouds, class Q>
auto ask(const On& on, const Robot& robot, const Poses& poses, const Clouds& clouds, const Q& q) {
  if constexpr (detail::explain_asked<On, Robot, Q>() && explain_given<Clouds>())
    return detail::one_call<On>::of(on, [&](auto... memory) {
      query once(on, robot, q, memory...);
      return once(poses, clouds);
    });
}
template <class On, class Robot, class Poses, class S, class Pose, class Q>
auto ask(const On& on, const Robot& robot, const Poses& poses, const S& source, const Pose& pose, const Q& q) {
  if constexpr (explain_given<S, Pose>()) return ask(on, robot, poses, as_clouds(source, pose), q);
}

/// Asks once and does not wait. The arguments are those of a `query` and of its `enqueue`.
template <class On, class Robot, class Poses, class Clouds, class Q>
auto enqueue(const On& on, const Robot& robot, const Poses& poses, const Clouds& clouds, const Q& q,
             const typename Q::out& to) {
  if constexpr (detail::explain_asked<On, Robot, Q>() && explain_given<Clouds>())
    return detail::one_call<On>::of(on, [&](auto... memory) {
      query once(on, robot, q, memory...);
      return once.enqueue(poses, clouds, to);
    });
}

}  // namespace clearance
