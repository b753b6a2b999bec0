// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Which of many configurations of one robot are nearer than a margin to anything that its sensors see? Runs on the
// host; include in_collisions.cuh for a device.

#include <clearance/in_collision.hpp>
#include <clearance/min_distances.hpp>

namespace clearance {

/// One state per configuration: that of in_collision for its poses. There is no witness, because it is chance which one
/// is found first; min_distances gives one.
struct in_collisions_result {
  std::vector<state> of;
  point_counts counts;  ///< All 0 if there was no configuration.

  /// The first configuration that is not certainly farther away than its margins, or of.size().
  std::size_t first_not_free() const { return first_of(of); }

  /// If the configurations are several trajectories, [batch, horizon]: the states of trajectory `i`, and the first of
  /// each trajectory, counted from its beginning. Throws std::invalid_argument if they are not whole trajectories of
  /// `horizon` configurations, or if there is no trajectory i.
  std::span<const state> trajectory(std::size_t i, std::size_t horizon) const {
    return detail::trajectory_of(std::span(of), i, horizon);
  }
  std::vector<std::size_t> first_not_free(std::size_t horizon) const {
    return detail::first_of_each(std::span(of), horizon, first_of);
  }

 private:
  static std::size_t first_of(std::span<const state> some) {
    return std::size_t(std::find_if(some.begin(), some.end(), [](state s) { return s != state::free; }) - some.begin());
  }
};

/// The prepared question, asked in every frame: it keeps its memory. Use one object from one thread and one stream.
/// Include in_collisions.cuh for a device. A backend of your own asks about each configuration by itself.
template <class On, class PartView>
class in_collisions_query {
  static_assert(
      !requires { typename On::own_scan; },
      "a device has a search of its own: include <clearance/in_collisions.cuh>, not the .hpp");

 public:
  template <robot Robot>
  in_collisions_query(const On& on, const Robot& robot) : on_(on), model_(view_of(robot)) {}

  /// As in_collisions. The result stays valid until the next call.
  template <class Clouds>
  const in_collisions_result& operator()(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds,
                                         std::span<const double> margins) {
    static_assert(explain_clouds<Clouds>());
    pairwise::check_margins(margins, model_.size());
    result_.of.resize(detail::count_configurations(model_.size(), poses.size()));
    result_.counts = {};
    detail::named(model_.size(), poses, [&] {
      for (std::size_t c = 0; c < result_.of.size(); ++c) {
        const collision_result one =
            in_collision(on_, model_, poses.subspan(c * model_.size(), model_.size()), clouds, margins);
        result_.of[c] = one.state, result_.counts = one.counts;
      }
    });
    return result_;
  }
  template <class Clouds>
  const in_collisions_result& operator()(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds,
                                         double margin = 0) {
    return (*this)(poses, clouds, std::span<const double>(&margin, 1));
  }

 private:
  On on_;
  model_view<PartView> model_;
  in_collisions_result result_;
};

/// On the CPU. The robot must outlive it.
template <class PartView>
class in_collisions_query<host, PartView> {
 public:
  template <robot Robot>
  in_collisions_query(const host& on, const Robot& robot) : search_(on, view_of(robot)) {}

  /// The same for joint vectors, one after another. Throws std::invalid_argument as joint_chain::count, too.
  template <class Clouds>
  const in_collisions_result& operator()(const joint_chain<host>& chain, std::span<const double> q,
                                         const Clouds& clouds, double margin = 0) {
    detail::check_chain(search_.parts(), chain.parts());
    return (*this)(chain.poses(q), clouds, margin);
  }
  /// As in_collisions. The result stays valid until the next call.
  template <class Clouds>
  const in_collisions_result& operator()(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds,
                                         std::span<const double> margins) {
    static_assert(explain_clouds<Clouds>());
    pairwise::check_margins(margins, search_.parts());
    result_.of.resize(detail::count_configurations(search_.parts(), poses.size()));
    const minimum::margin_question question{margins.data(), std::uint32_t(margins.size())};
    detail::named(search_.parts(), poses, [&] { result_.counts = search_(poses, clouds, question, result_.of); });
    return result_;
  }
  template <class Clouds>
  const in_collisions_result& operator()(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds,
                                         double margin = 0) {
    return (*this)(poses, clouds, std::span<const double>(&margin, 1));
  }

 private:
  minimum::host_batch<PartView, minimum::margin_question> search_;
  in_collisions_result result_;
};

template <class On, robot Robot>
in_collisions_query(const On&, const Robot&)
    -> in_collisions_query<On, typename decltype(view_of(std::declval<const Robot&>()))::part_type>;

/// Is any point closer to a configuration than `margins`, in metres: one for all parts, or one per part? `poses` as for
/// min_distances. Throws std::invalid_argument as that does, if there are neither one nor as many margins as parts,
/// or one is NaN.
template <class On, robot Robot, class Clouds>
in_collisions_result in_collisions(const On& on, const Robot& robot, std::span<const Eigen::Isometry3d> poses,
                                   const Clouds& clouds, std::span<const double> margins) {
  static_assert(explain_clouds<Clouds>());
  return detail::one_call<On>::of(on, [&](auto... memory) {
    in_collisions_query query(on, robot, memory...);
    return query(poses, clouds, margins);
  });
}
/// The same with one margin for all parts.
template <class On, robot Robot, class Clouds>
in_collisions_result in_collisions(const On& on, const Robot& robot, std::span<const Eigen::Isometry3d> poses,
                                   const Clouds& clouds, double margin = 0) {
  return in_collisions(on, robot, poses, clouds, std::span<const double>(&margin, 1));
}

}  // namespace clearance
