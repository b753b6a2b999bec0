// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/query/in_use.hpp>
#include <clearance/query/one_robot.hpp>

namespace clearance::detail {

/// How every prepared question is asked. `Query` has `run(poses, clouds, question)`, and what else it can.
template <class Query, class Q>
class callable {
 public:
  /// Blocks until the answer is there. `poses` are world-from-part, one per part; `clouds` is a point source, a
  /// `placed` one, a range or a tuple of those, or a source and its pose. Points that the backend cannot read are
  /// copied. Throws std::invalid_argument if the number of poses is wrong, one is not rigid, or an option cannot be.
  template <class Poses, class Clouds>
  decltype(auto) operator()(const Poses& poses, const Clouds& clouds, const Q& q) {
    static_assert(explain_given<Clouds>());
    const in_use::call only(used_);
    return self().run(as_poses(poses), clouds, q);
  }
  template <class Poses, class Clouds>
  decltype(auto) operator()(const Poses& poses, const Clouds& clouds) {
    return (*this)(poses, clouds, asked_);
  }
  template <class Poses, class S, class Pose>
    requires(!requires(const Poses& chain) { chain.parts(); })
  decltype(auto) operator()(const Poses& poses, const S& source, const Pose& pose, const Q& q) {
    return (*this)(poses, as_clouds(source, pose), q);
  }
  template <class Poses, class S, class Pose>
    requires(!requires(const Poses& chain) { chain.parts(); })
  decltype(auto) operator()(const Poses& poses, const S& source, const Pose& pose) {
    return (*this)(poses, as_clouds(source, pose), asked_);
  }
  /// For questions about many configurations: the same for joint vectors of a chain, one after another.
  template <class Chain, class Clouds>
    requires requires(const Chain& chain) { chain.parts(); }
  decltype(auto) operator()(const Chain& chain, std::span<const double> joints, const Clouds& clouds, const Q& q) {
    const in_use::call only(used_);
    return self().run_chain(chain, joints, clouds, q);
  }
  template <class Chain, class Clouds>
    requires requires(const Chain& chain) { chain.parts(); }
  decltype(auto) operator()(const Chain& chain, std::span<const double> joints, const Clouds& clouds) {
    return (*this)(chain, joints, clouds, asked_);
  }
  /// On a device: about the configurations that were placed.
  template <class Clouds>
  decltype(auto) operator()(const Clouds& clouds, const Q& q) {
    const in_use::call only(used_);
    return self().run_placed(clouds, q);
  }
  template <class Clouds>
  decltype(auto) operator()(const Clouds& clouds) {
    return (*this)(clouds, asked_);
  }

 protected:
  explicit callable(const Q& q) : asked_(q) {}
  const Q& asked() const { return asked_; }
  in_use& used() { return used_; }

 private:
  Query& self() { return static_cast<Query&>(*this); }

  Q asked_;
  in_use used_;
};

}  // namespace clearance::detail
