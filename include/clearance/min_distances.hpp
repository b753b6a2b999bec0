// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// How far are many configurations of one robot, such as the waypoints of a trajectory, from everything that its sensors
// see? Runs on the host; include min_distances.cuh for a device.

#include <clearance/answer/configurations.hpp>
#include <clearance/answer/host_batch.hpp>
#include <clearance/answer/margins.hpp>
#include <clearance/answer/search_on.hpp>
#include <clearance/backend/one_call.hpp>

namespace clearance {

struct min_distances_options {
  real d_max = infinity;  ///< Metres. For a configuration farther away only that fact is reported, much faster.
};

/// One result per configuration: that of min_distance for its poses, to the bit, if it is at most d_max. Otherwise the
/// distance is infinite, there is no witness, and `lower` is what is certain: d_max less gap, tolerance and rounding.
struct min_distances_result {
  std::vector<min_distance_result> of;

  /// The first configuration that is not certainly farther away than `margin` metres, or of.size(). Without a valid
  /// point it is the first. Throws std::invalid_argument if the margin is negative or NaN: `lower` is 0 in a collision,
  /// too.
  std::size_t first_below(double margin) const {
    check(margin);
    return first_of(of, margin);
  }

  /// If the configurations are several trajectories, [batch, horizon]: the results of trajectory `i`. Throws
  /// std::invalid_argument if they are not whole trajectories of `horizon` configurations, or if there is no trajectory
  /// i.
  std::span<const min_distance_result> trajectory(std::size_t i, std::size_t horizon) const {
    return detail::trajectory_of(std::span(of), i, horizon);
  }
  /// `first_below` of each trajectory, counted from its beginning.
  std::vector<std::size_t> first_below(double margin, std::size_t horizon) const {
    check(margin);
    return detail::first_of_each(std::span(of), horizon, [&](auto its) { return first_of(its, margin); });
  }

 private:
  static void check(double margin) {
    if (!(margin >= 0))
      throw std::invalid_argument("clearance: the margin is " + std::to_string(margin) + " m; it must not be negative");
  }
  static std::size_t first_of(std::span<const min_distance_result> some, double margin) {
    const auto near = [margin](const min_distance_result& r) {
      return r.state == state::no_data || !(double(r.lower) > margin);
    };
    return std::size_t(std::find_if(some.begin(), some.end(), near) - some.begin());
  }
};

namespace detail {

inline void check(const min_distances_options& options) {
  if (!(options.d_max == options.d_max)) throw std::invalid_argument("clearance: d_max is not a number");
}

}  // namespace detail

/// The prepared question, asked in every frame. It keeps its memory, and remembers where each configuration's last
/// minimum was, which only makes it faster. Use one object from one thread and one stream. Include min_distances.cuh
/// for a device. A backend of your own asks about each configuration by itself.
template <class On, class PartView>
class min_distances_query {
  static_assert(
      !requires { typename On::own_scan; },
      "a device has a search of its own: include <clearance/min_distances.cuh>, not the .hpp");

 public:
  template <robot Robot>
  min_distances_query(const On& on, const Robot& robot) : on_(on), model_(view_of(robot)) {}

  template <class Clouds>
  const min_distances_result& operator()(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds,
                                         const min_distances_options& options = {}) {
    static_assert(explain_clouds<Clouds>());
    detail::check(options);
    result_.of.resize(detail::count_configurations(model_.size(), poses.size()));
    detail::named(model_.size(), poses, [&] { each(poses, clouds, options.d_max); });
    return result_;
  }
  void forget() {}

 private:
  template <class Clouds>
  void each(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, real d_max) {
    using search = minimum::search_on<On>;
    using there = std::remove_cvref_t<decltype(search::backend_of(on_))>;
    const there& backend = search::backend_of(on_);
    minimum::cloud_copies<there> copies;
    auto one = backend.template make_scratch<min_distance_result>(1);
    for (std::size_t c = 0; c < result_.of.size(); ++c) {
      const auto own = poses.subspan(c * model_.size(), model_.size());
      frames::cloud_frame frame;
      frames::for_each_turn(frame, model_.facts, own, clouds, [](const auto&, const frames::turn&) {});
      search::template once<false>(on_, model_, own, clouds, one.data(), nullptr,
                                   minimum::readable_on<there>{backend, copies});
      result_.of[c] = backend.copy_out(one.data(), 1)[0];
      minimum::cut(result_.of[c], d_max, frame.slop, frame.error);
    }
  }

  On on_;
  model_view<PartView> model_;
  min_distances_result result_;
};

/// On the CPU. The robot must outlive it.
template <class PartView>
class min_distances_query<host, PartView> {
 public:
  template <robot Robot>
  min_distances_query(const host& on, const Robot& robot) : search_(on, view_of(robot)) {}

  /// The same for joint vectors, one after another. Throws std::invalid_argument as joint_chain::count, too.
  template <class Clouds>
  const min_distances_result& operator()(const joint_chain<host>& chain, std::span<const double> q,
                                         const Clouds& clouds, const min_distances_options& options = {}) {
    detail::check_chain(search_.parts(), chain.parts());
    return (*this)(chain.poses(q), clouds, options);
  }
  /// As min_distances. The result stays valid until the next call.
  template <class Clouds>
  const min_distances_result& operator()(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds,
                                         const min_distances_options& options = {}) {
    static_assert(explain_clouds<Clouds>());
    detail::check(options);
    result_.of.resize(detail::count_configurations(search_.parts(), poses.size()));
    detail::named(search_.parts(), poses, [&] { search_(poses, clouds, {options.d_max}, result_.of); });
    return result_;
  }

  /// Forgets the last frame. The next one starts cold; its answer is the same.
  void forget() { search_.forget(); }

 private:
  minimum::host_batch<PartView, minimum::least_question> search_;
  min_distances_result result_;
};

template <class On, robot Robot>
min_distances_query(const On&, const Robot&)
    -> min_distances_query<On, typename decltype(view_of(std::declval<const Robot&>()))::part_type>;

/// The least distance of each configuration. `poses` are world-from-part: one per part of the first configuration, then
/// those of the next. `clouds` as for min_distance. Throws std::invalid_argument as that does, and if the poses are not
/// whole configurations, or d_max is NaN.
template <class On, robot Robot, class Clouds>
min_distances_result min_distances(const On& on, const Robot& robot, std::span<const Eigen::Isometry3d> poses,
                                   const Clouds& clouds, const min_distances_options& options = {}) {
  static_assert(explain_clouds<Clouds>());
  return detail::one_call<On>::of(on, [&](auto... memory) {
    min_distances_query query(on, robot, memory...);
    return query(poses, clouds, options);
  });
}

}  // namespace clearance
