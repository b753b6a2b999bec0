// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Asks for the least distance on one backend, frame after frame.

#include <clearance/frames/readable.hpp>
#include <clearance/minimum/host_search.hpp>

namespace clearance::minimum {

/// Where a question about the least distance writes: `Q::per_part` decides whether also every part's.
template <class Q>
auto minima_of(const typename Q::out& to) {
  if constexpr (Q::per_part)
    return std::pair(to.result, to.minima);
  else
    return std::pair(to, static_cast<part_minimum*>(nullptr));
}

/// For a backend without a search of its own: a loop over points, which keeps nothing from frame to frame.
template <class On, class PartView, class Q>
class engine {
 public:
  template <class... Memory>
  engine(const On& on, const model_view<PartView>& model, Memory... from)
      : on_(on), parts_(model.size()), readable_(on, from...), search_(on, model) {}

  template <class Clouds>
  typename Q::result run(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const Q&) {
    auto result = on_.template make_scratch<min_distance_result>(1);
    auto minima = on_.template make_scratch<part_minimum>(Q::per_part ? parts_ : 0);
    search_(poses, readable_(clouds), result.data(), Q::per_part ? minima.data() : nullptr);
    if constexpr (Q::per_part)
      return {on_.copy_out(result.data(), 1)[0], on_.copy_out(minima.data(), minima.size())};
    else
      return on_.copy_out(result.data(), 1)[0];
  }
  template <class Clouds>
  void start(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const Q&, const typename Q::out& to) {
    const auto [result, minima] = minima_of<Q>(to);
    search_(poses, clouds, result, minima);
  }
  /// The host waits, so that this is all.
  template <class Clouds>
  void begin(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const Q& q) {
    result_ = run(poses, clouds, q);
  }
  const typename Q::result& finish() const { return result_; }
  void reserve() const {}
  void forget() const {}

 private:
  On on_;
  std::size_t parts_;
  frames::readable_clouds<On> readable_;
  plain_search<On, PartView> search_;
  typename Q::result result_;
};

/// On the CPU, with any tree. After the first frames of a size it allocates nothing.
template <class PartView, class Q>
class engine<host, PartView, Q> {
 public:
  engine(const host& on, const model_view<PartView>& model) : search_(on, model) {}

  /// The result stays valid until the next call.
  template <class Clouds>
  const typename Q::result& run(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const Q&) {
    if constexpr (Q::per_part) {
      result_.parts.resize(search_.parts());
      search_(poses, clouds, &result_.all, result_.parts.data());
    } else {
      search_(poses, clouds, &result_);
    }
    return result_;
  }
  /// A host has nothing to wait for.
  template <class Clouds>
  void begin(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const Q& q) {
    run(poses, clouds, q);
  }
  const typename Q::result& finish() const { return result_; }
  void reserve() const {}
  template <class Clouds>
  void start(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const Q&, const typename Q::out& to) {
    const auto [result, minima] = minima_of<Q>(to);
    search_(poses, clouds, result, minima);
  }

  /// For the next frame only: pairs farther than `within` metres need not be found. If no pair is nearer, the answer
  /// has no witness and the state `no_data`, whatever points there were.
  void bound_by(real within)
    requires(!Q::per_part)
  {
    search_.bound_by(within);
  }
  /// Forgets the last frame. The next one starts cold; its answer is the same.
  void forget() { search_.forget(); }

 private:
  host_search<PartView> search_;
  typename Q::result result_;
};

}  // namespace clearance::minimum
