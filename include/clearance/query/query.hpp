// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Asks any question: once, or prepared for every frame.

#include <clearance/backends/one_call.hpp>
#include <clearance/backends/plain.hpp>
#include <clearance/frames/readable.hpp>
#include <clearance/query/combination.hpp>
#include <clearance/query/engine.hpp>
#include <clearance/robot/model.hpp>
#include <clearance/visitor/nearest.hpp>

#include <atomic>
#include <memory>
#include <stdexcept>

namespace clearance::detail {

// A prepared object used twice at once, which debug builds refuse.

/// Is a prepared object being asked? Copies are other objects. It has a size in release builds, too, so that both kinds
/// of build agree about objects that they share.
class in_use {
 public:
  in_use() = default;
  in_use(const in_use&) noexcept {}
  in_use& operator=(const in_use&) noexcept { return *this; }

  /// One call.
  class [[nodiscard]] call {
   public:
    /// Without NDEBUG: throws std::logic_error if another call has not returned.
    explicit call([[maybe_unused]] in_use& object) {
#if !defined(NDEBUG)
      if (object.now_.exchange(true, std::memory_order_acquire))
        throw std::logic_error(
            "clearance: a prepared question is asked while it is being asked; give each thread its own");
      object_ = &object;
#endif
    }
    call(const call&) = delete;
    call& operator=(const call&) = delete;
    ~call() {
#if !defined(NDEBUG)
      object_->now_.store(false, std::memory_order_release);
#endif
    }

#if !defined(NDEBUG)
   private:
    in_use* object_;
#endif
  };

 private:
  std::atomic<bool> now_ = false;
};

// The arguments of a question as an engine takes them.

/// A robot where one backend runs. A part alone becomes a robot of one part, in memory that this keeps.
template <class On, class PartView>
class one_robot {
  using buffer = typename On::template buffer<PartView>;

 public:
  template <robot Robot>
  one_robot(const On&, const Robot& robot) : view_(view_of(robot)) {
    if constexpr (!requires { robot.view(); }) check_by_hand(view_);
  }

  template <rigid_part Part>
  one_robot(const On& on, const Part& part) : view_{nullptr, {&part.facts, 1}, 0, 0} {
    const PartView its = part.view();
    check(part.facts, 0);
    own_ = std::make_shared<const buffer>(on.copy_in(std::span(&its, 1)));
    view_ = {own_->data(), view_.facts, its.tree.depth(), its.tree.width()};
  }

  const model_view<PartView>& view() const { return view_; }

 private:
  /// A view that no model made: where the host reads parts, it also says whether they are as the view says.
  static void check_by_hand(const model_view<PartView>& view) {
    if (view.size() != 0 && view.parts == nullptr)
      throw std::invalid_argument("clearance: a view of " + std::to_string(view.size()) +
                                  " parts has none: they are null");
    if constexpr (std::is_base_of_v<host, On>)
      for (std::size_t k = 0; k < view.size(); ++k) {
        const PartView& its = view.parts[k];
        if (its.tree.depth() > view.depth || its.tree.width() > view.width)
          throw std::invalid_argument("clearance: the tree of part " + std::to_string(k) +
                                      " is deeper or wider than the robot's view says");
        if (!(its.facts == view.facts[k]))
          throw std::invalid_argument("clearance: the facts of part " + std::to_string(k) +
                                      " are not those of its view");
      }
  }

  model_view<PartView> view_;
  std::shared_ptr<const buffer> own_;  // an engine looks at it, and so do its copies
};

/// Throws std::invalid_argument for options that no frame could mend: what a `checking_question` refuses.
template <class Q>
void check_options(const Q& q, std::size_t parts) {
  if constexpr (requires { q.check(parts); })
    q.check(parts);
  else if constexpr (checking_question<Q>)
    q.check();
}

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

/// How every prepared question is asked: by the `begin` and `finish` of `Query`, and what else it can.
template <class Query, class On, class Q>
class callable {
 public:
  /// Blocks until the answer is there. `poses` are world-from-part, one per part; `clouds` is a point source, a
  /// `placed` one, a range or a tuple of those, or a source and its pose. Points that the backend cannot read are
  /// copied. Throws std::invalid_argument if the number of poses is wrong, one is not rigid, or an option cannot be.
  template <class Poses, class Clouds>
  decltype(auto) operator()(const Poses& poses, const Clouds& clouds, const Q& q) & {
    if constexpr (explain_given<Clouds>())
      if constexpr (explain_combination<Q, Clouds, form::once, On>()) {
        const in_use::call only(used_);
        self().begin(as_poses(poses), clouds, q);
        return finished();
      }
  }
  template <class Poses, class Clouds>
  decltype(auto) operator()(const Poses& poses, const Clouds& clouds) & {
    return (*this)(poses, clouds, asked_);
  }
  template <class Poses, class S, class Pose>
    requires(!requires(const Poses& chain) { chain.parts(); })
  decltype(auto) operator()(const Poses& poses, const S& source, const Pose& pose, const Q& q) & {
    return (*this)(poses, as_clouds(source, pose), q);
  }
  template <class Poses, class S, class Pose>
    requires(!requires(const Poses& chain) { chain.parts(); })
  decltype(auto) operator()(const Poses& poses, const S& source, const Pose& pose) & {
    return (*this)(poses, as_clouds(source, pose), asked_);
  }
  /// For questions about many configurations: the same for joint vectors of a chain, one after another.
  template <class Chain, class Clouds>
    requires requires(const Chain& chain) { chain.parts(); }
  decltype(auto) operator()(const Chain& chain, std::span<const double> joints, const Clouds& clouds, const Q& q) & {
    using many = std::conditional_t<planning_question<Q>, refusals::none, refusals::not_many>;
    if constexpr (many::template explain<Q>() && explain_given<Clouds>())
      if constexpr (explain_combination<Q, Clouds, form::once, On>()) {
        const in_use::call only(used_);
        self().begin_chain(chain, joints, clouds, q);
        return finished();
      }
  }
  template <class Chain, class Clouds>
    requires requires(const Chain& chain) { chain.parts(); }
  decltype(auto) operator()(const Chain& chain, std::span<const double> joints, const Clouds& clouds) & {
    return (*this)(chain, joints, clouds, asked_);
  }
  /// A temporary query takes its memory with it, so this returns the result itself.
  template <class... Arguments>
  auto operator()(const Arguments&... arguments) && {
    decltype(auto) its = static_cast<callable&>(*this)(arguments...);
    if constexpr (std::is_reference_v<decltype(its)>)
      return typename Q::result(std::move(const_cast<typename Q::result&>(its)));
    else
      return its;
  }
  /// On a device: about the configurations that were placed.
  template <class Clouds>
  decltype(auto) operator()(const Clouds& clouds, const Q& q) & {
    constexpr bool places = requires(Query& its) { its.begin_placed(clouds, q); };
    if constexpr (std::conditional_t<places, refusals::none, refusals::not_placed>::template explain<Q>())
      if constexpr (explain_combination<Q, Clouds, form::once, On>()) {
        const in_use::call only(used_);
        self().begin_placed(clouds, q);
        return finished();
      }
  }
  template <class Clouds>
  decltype(auto) operator()(const Clouds& clouds) & {
    return (*this)(clouds, asked_);
  }

 protected:
  explicit callable(const Q& q) : asked_(q) {}
  const Q& asked() const { return asked_; }
  in_use& used() { return used_; }

 private:
  Query& self() { return static_cast<Query&>(*this); }
  /// The result of the frame that began; where the engine keeps it, a reference.
  decltype(auto) finished() {
    if constexpr (std::is_reference_v<decltype(self().finish())>)
      return static_cast<const typename Q::result&>(self().finish());
    else
      return self().finish();
  }

  Q asked_;
  in_use used_;
};

}  // namespace clearance::detail

namespace clearance {

namespace detail {

/// Where a backend writes, for a question that can be enqueued so.
struct nowhere {
  nowhere() = delete;
};
template <class Q>
struct out_of {
  using type = nowhere;
};
template <writing_question Q>
struct out_of<Q> {
  using type = typename Q::out;
};

/// Refuses to enqueue what says nowhere to write.
template <class Q, class On>
consteval bool explain_unwritten() {
  using form_alone = decltype(refusal_of_form<Q, form::enqueued, On>());
  using why = std::conditional_t<form_alone::sentence == nullptr, refusals::placed_first, form_alone>;
  return why::template explain<Q, On>();
}

/// Does an engine read poses where a device has them, and does it place configurations there?
template <class Engine, class S, class Out>
concept reads_poses = requires(Engine& its, const world_transform* poses, const S& source, const Out& to) {
  its.start_with(poses, source, poses, to);
};
template <class Engine, class Clouds, class Q>
concept places = requires(Engine& its, const Clouds& clouds, const Q& q) { its.start_placed(clouds, q); };

/// Is there a scan for this backend? <clearance/device.cuh> says so for devices.
template <class On>
inline constexpr bool has_scan = !requires { typename On::own_scan; };

/// Where it is asked, with reasons.
template <class On>
consteval bool explain_backend() {
  constexpr bool several = requires { typename On::several; }, known = backend<On> || several;
  static_assert(known, "the first argument is a backend: host{}, device{}, devices{...}, or plain{backend, traversal}");
  constexpr bool one_walks = !is_plain<On> || !several;
  static_assert(one_walks,
                "plain takes one backend, host{} or device{}: several devices walk by their own kernels, and ranks are "
                "asked by shard{comm, plain{backend, traversal}}");
  static_assert(!known || !one_walks || has_scan<On>, "a device is asked with nvcc: include <clearance/device.cuh>");
  return known && one_walks && has_scan<On>;
}

/// What is asked, and of whom, with reasons; before anything else is looked at.
template <class On, class Robot, class Q>
consteval bool explain_asked() {
  if constexpr (explain_backend<On>() && explain_robot<Robot>() && explain_question<Q>()) {
    if constexpr (is_plain<On>)
      return explain_traversal<decltype(On::walk), typename part_view_of<Robot>::type::hierarchy_type, nearest>();
    return true;
  }
  return false;
}

}  // namespace detail

/// A prepared question: make it once for a robot, and ask it in every frame with new poses and points, or with other
/// options. It keeps its memory. What it remembers of the last frame only makes it faster. Use one object from one
/// stream and one thread (two at once: a debug build throws std::logic_error); the robot must outlive it and its
/// copies. Options that no frame could mend are refused when it is made (std::invalid_argument). On a device, `memory`
/// may be a std::pmr::memory_resource* that hands out device memory.
template <question Q, class On, class PartView>
class query : detail::one_robot<On, PartView>,
              public detail::engine_of<Q, On, PartView>::type,
              public detail::callable<query<Q, On, PartView>, On, Q> {
  using robot_type = detail::one_robot<On, PartView>;
  using callable = detail::callable<query, On, Q>;
  using engine = typename detail::engine_of<Q, On, PartView>::type;
  using out = typename detail::out_of<Q>::type;

 public:
  template <class Robot, class... Memory>
  query(const On& on, const Robot& robot, const Q& asked, Memory... memory)
      : robot_type(on, robot), engine(on, robot_type::view(), memory...), callable(asked) {
    static_assert(detail::explain_asked<On, Robot, Q>() && explain_engine<engine, Q>());
    if constexpr (detail::is_plain<On>) scan::walk_of(on, robot_type::view());  // refuses trees too deep for it
    detail::check_options(asked, robot_type::view().size());
  }
  template <owning_robot Robot, class... Memory>
  query(const On&, const Robot&&, const Q&, Memory...) = delete;  // the robot would be gone when it is asked; name it

  /// Enqueues a frame and does not wait. Clouds must be readable where it runs; they, and all that `to` names, must
  /// stay until it is done. On a device, a graph that captures this keeps the current poses and options.
  template <class Poses, class Clouds>
  auto enqueue(const Poses& poses, const Clouds& clouds, const Q& q, const out& to) {
    if constexpr (explain_given<Clouds>())
      if constexpr (explain_combination<Q, Clouds, form::enqueued, On>()) {
        const detail::in_use::call only(callable::used());
        return engine::start(detail::as_poses(poses), clouds, q, to);
      }
  }
  template <class Poses, class Clouds>
  auto enqueue(const Poses& poses, const Clouds& clouds, const out& to) {
    return enqueue(poses, clouds, callable::asked(), to);
  }
  /// The same with poses in device or pinned memory: one per part, and the cloud's (null: the world's). A graph that
  /// captures this sees the memory of each launch.
  template <class S>
    requires point_source<S> || point_container<S>
  void enqueue(const world_transform* poses, const S& cloud, const world_transform* cloud_pose, const out& to) {
    constexpr bool reads = detail::reads_poses<engine, point_span, out>;
    static_assert(reads,
                  "poses in memory are read by min_distance and min_distance_per_part on a device{}, not by plain");
    if constexpr (reads && point_container<S>) {
      enqueue(poses, points_of(cloud), cloud_pose, to);
    } else if constexpr (reads) {
      const detail::in_use::call only(callable::used());
      engine::start_with(poses, detail::read_here(cloud), cloud_pose, to);
    }
  }
  /// About placed configurations: returns device memory with one result per configuration.
  template <class Clouds>
  auto enqueue(const Clouds& clouds, const Q& q) {
    constexpr bool places = detail::places<engine, Clouds, Q>;
    if constexpr (std::conditional_t<places, refusals::none, refusals::not_placed>::template explain<Q>())
      if constexpr (explain_combination<Q, Clouds, form::enqueued, On>()) {
        const detail::in_use::call only(callable::used());
        return engine::start_placed(clouds, q);
      }
  }
  template <class Clouds>
  auto enqueue(const Clouds& clouds) {
    return enqueue(clouds, callable::asked());
  }
  /// A question that has no `out` is refused with a sentence.
  template <class Poses, class Clouds, class... Others>
  void enqueue(const Poses&, const Clouds&, const Others&...)
    requires(!writing_question<Q> && sizeof...(Others) > 0)
  {
    detail::explain_unwritten<Q, On>();
  }

  std::span<const part_facts> facts() const { return robot_type::view().facts; }
};
template <class On, class Robot, class Q, class... Memory>
query(const On&, const Robot&, const Q&, Memory...) -> query<Q, On, typename detail::part_view_of<Robot>::type>;

/// Asks once. The arguments are those of a `query` and of its call.
template <class On, class Robot, class Poses, class Clouds, class Q>
auto ask(const On& on, const Robot& robot, const Poses& poses, const Clouds& clouds, const Q& q) {
  if constexpr (detail::explain_asked<On, Robot, Q>() && explain_given<Clouds>())
    return detail::one_call<On>::of(on, [&](auto... memory) { return query(on, robot, q, memory...)(poses, clouds); });
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
/// A question that has no `out` is refused with a sentence.
template <class On, class Robot, class Poses, class Clouds, class Q, class To>
  requires(question<Q> && !writing_question<Q>)
void enqueue(const On&, const Robot&, const Poses&, const Clouds&, const Q&, const To&) {
  detail::explain_unwritten<Q, On>();
}

}  // namespace clearance
