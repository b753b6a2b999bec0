// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What asks a question on one backend, frame after frame: the question's own engine, or the one for pairs.

#include <clearance/frames/clouds.hpp>
#include <clearance/pairwise/engine.hpp>
#include <clearance/points/point_span.hpp>

namespace clearance {

/// What a `query` inherits from. It is made of a backend, a view of the robot there, and perhaps memory.
///
/// Law: `begin(poses, clouds, q)` enqueues a frame, and `finish()` waits for its result, which stays valid until the
/// next call; `q` and the clouds' memory must stay until then. `forget()` drops what is known of the last frame, which
/// only makes the next one faster. An engine may also have `start(poses, clouds, q, out)`, which enqueues a frame whose
/// result goes to `out`; where that is asked for, it must be there.
template <class E, class Q>
concept engine_for =
    requires(E its, std::span<const Eigen::Isometry3d> poses, const placed<point_span>& clouds, const Q& q) {
      its.begin(poses, clouds, q);
      { its.finish() } -> std::convertible_to<typename Q::result>;
      its.forget();
    };

/// An engine whose `begin` waits, because the host decides between passes over the points. On several devices each has
/// a thread.
template <class E>
concept waiting_engine = E::waits;

/// An engine that takes a bound. Law: `bound_by(within)` is for the next frame alone, in which pairs farther than
/// `within` metres need not be found.
template <class E>
concept bounded_engine = requires(E its, real within) { its.bound_by(within); };

/// An engine that keeps the poses of many configurations where it runs: `place(poses)`, and then `begin_placed(clouds,
/// q)` or `start_placed(clouds, q)`.
template <class E>
concept placing_engine = requires(E its, std::span<const Eigen::Isometry3d> poses) { its.place(poses); };

/// A device's engine that takes a resource of pinned memory after that of device memory.
template <class E>
concept pinning_engine = E::takes_pinned;

/// `engine_for<E, Q>` with reasons.
template <class E, class Q>
consteval bool explain_engine() {
  static_assert(
      requires(E its, std::span<const Eigen::Isometry3d> poses, const placed<point_span>& clouds, const Q& q) {
        its.begin(poses, clouds, q);
      },
      "an engine needs: template <class Clouds> void begin(std::span<const Eigen::Isometry3d> poses, const Clouds&, "
      "const question&)");
  static_assert(
      requires(E its) {
        { its.finish() } -> std::convertible_to<typename Q::result>;
      }, "an engine needs: result finish(), or const result& finish(), for the frame that began");
  static_assert(requires(E its) { its.forget(); }, "an engine needs: void forget(), which may do nothing");
  return engine_for<E, Q>;
}

}  // namespace clearance

namespace clearance::detail {

/// What answers a question on one backend.
template <class Q, class On, class PartView>
struct engine_of {
  static_assert(pairwise::explain_pair_question<Q>());
  using type = pairwise::engine<Q, On, PartView>;
};
template <class Q, class On, class PartView>
  requires(own_engine::is_there<Q>())
struct engine_of<Q, On, PartView> {
  using type = typename Q::template engine<On, PartView>;
};

}  // namespace clearance::detail
