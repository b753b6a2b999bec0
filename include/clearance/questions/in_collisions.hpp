// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Which of many configurations of one robot are nearer than a margin to anything that its sensors see?

#include <clearance/plan/engine.hpp>
#include <clearance/questions/in_collision.hpp>

#if defined(__CUDACC__)
#include <clearance/cloud_tree/device_sums.cuh>  // for a tree over points on a device
#include <clearance/plan/device_engine.cuh>
#endif

namespace clearance {

/// One state per configuration: that of in_collision for its poses. There is no witness, because it is chance which one
/// is found first; min_distances gives one.
struct in_collisions_result {
  arriving<state> of;
  point_counts counts;  ///< All 0 if there was no configuration.

  /// The first configuration that is not certainly farther away than its margins, or of.size().
  std::size_t first_not_free() const { return first_of(of); }

  /// If the configurations are several trajectories, [batch, horizon]: the states of trajectory `i`, and the first of
  /// each trajectory, counted from its beginning. Throws std::invalid_argument if they are not whole trajectories of
  /// `horizon` configurations, std::out_of_range if there is no trajectory i.
  std::span<const state> trajectory(std::size_t i, std::size_t horizon) const& {
    return plan::trajectory_of(std::span(of), i, horizon);
  }
  /// A copy: a temporary result is gone before a view of it is read.
  std::vector<state> trajectory(std::size_t i, std::size_t horizon) const&& {
    const auto view = trajectory(i, horizon);
    return {view.begin(), view.end()};
  }
  std::vector<std::size_t> first_not_free(std::size_t horizon) const {
    return plan::first_of_each(std::span(of), horizon, first_of);
  }

 private:
  static std::size_t first_of(std::span<const state> some) {
    return std::size_t(std::find_if(some.begin(), some.end(), [](state s) { return s != state::free; }) - some.begin());
  }
};

/// Is any point closer to a configuration than the margins? `poses` as for min_distances. Refused: poses that are no
/// whole configurations, neither one nor as many margins as parts, one that is NaN, and radii as in_collision.
struct in_collisions {
  std::vector<double> margins = {0.0};  ///< Metres: one for all parts, or one per part.
  std::vector<double> radii = {};       ///< By how much parts may be elsewhere, in metres: all alike, or each.

  using result = in_collisions_result;
  using can = clearance::can<checking, merging, partial, planning, of_balls>;
  using searched = plan::margin_question;
  static constexpr bool each_part = false;
  template <class On, class PartView>
  using engine = plan::engine<On, PartView, in_collisions>;

  void check(std::size_t parts) const { in_collision{margins, radii}.check(parts); }
  searched checked(std::size_t parts) const {
    frames::check_margins(margins, parts);
    return {margins.data(), std::uint32_t(margins.size())};
  }
  static arriving<state>& results(result& r) { return r.of; }
  static void take_counts(result& r, const point_counts& counts, std::size_t) { r.counts = counts; }

  static void merge(result& whole, const result& other) {
    whole.counts.add(other.counts);
    const bool too_close = whole.counts.dropped[int(drop_reason::too_close)] != 0;
    for (std::size_t c = 0; c < whole.of.size(); ++c) {
      state& known = whole.of[c];
      const state others = other.of[c];
      if (known == state::collision || others == state::collision)
        known = state::collision;
      else if (known == state::no_data && others == state::no_data)
        known = state::no_data;
      else
        known = known == state::possible || others == state::possible || too_close ? state::possible : state::free;
    }
  }
  static void so_far(result& r, std::uint64_t unseen) {
    for (state& known : r.of)
      if (unseen != 0 && known != state::collision) known = state::possible;
  }

  template <class On, class PartView, class Clouds>
  void ask_one(const On& on, const model_view<PartView>& model, std::span<const Eigen::Isometry3d> poses,
               const Clouds& clouds, result& r, std::size_t c) const {
    const collision_result one = ask(on, model, poses, clouds, in_collision{margins});
    r.of[c] = one.state;
    r.counts = one.counts;
  }
};

}  // namespace clearance
