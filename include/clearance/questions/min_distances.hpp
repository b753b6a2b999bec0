// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// How far are many configurations of one robot, such as the waypoints of a trajectory, from everything that its sensors
// see?

#include <clearance/frames/bracket.hpp>
#include <clearance/plan/engine.hpp>
#include <clearance/questions/min_distance.hpp>

#if defined(__CUDACC__)
#include <clearance/cloud_tree/device_sums.cuh>  // for a tree over points on a device
#include <clearance/plan/device_engine.cuh>
#endif

namespace clearance {

/// One result per configuration: that of min_distance for its poses, to the bit, if it is at most d_max. Otherwise the
/// distance is infinite, there is no witness, and `lower` is what is certain: d_max less gap, tolerance and rounding.
struct min_distances_result {
  arriving<min_distance_result> of;

  /// The first configuration that is not certainly farther away than `margin` metres, or of.size(). Without a valid
  /// point it is the first. Throws std::invalid_argument if the margin is negative or NaN: `lower` is 0 in a collision,
  /// too.
  std::size_t first_below(double margin) const {
    check(margin);
    return first_of(of, margin);
  }

  /// If the configurations are several trajectories, [batch, horizon]: the results of trajectory `i`. Throws
  /// std::invalid_argument if they are not whole trajectories of `horizon` configurations, std::out_of_range if there
  /// is no trajectory i.
  std::span<const min_distance_result> trajectory(std::size_t i, std::size_t horizon) const& {
    return plan::trajectory_of(std::span(of), i, horizon);
  }
  /// A copy: a temporary result is gone before a view of it is read.
  std::vector<min_distance_result> trajectory(std::size_t i, std::size_t horizon) const&& {
    const auto view = trajectory(i, horizon);
    return {view.begin(), view.end()};
  }
  /// `first_below` of each trajectory, counted from its beginning.
  std::vector<std::size_t> first_below(double margin, std::size_t horizon) const {
    check(margin);
    return plan::first_of_each(std::span(of), horizon, [&](auto results) { return first_of(results, margin); });
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

namespace plan {

/// Answers about pieces of all clouds. `Q::results(result)` are those of all configurations.
template <class Q, class PartView>
class joined_minima {
 public:
  joined_minima(const Q&, std::span<const part_facts>) {}

  void add(typename Q::result piece, const piece_place& place) {
    auto& results = Q::results(piece);
    for (min_distance_result& r : results)
      if (r.cloud != none) r.point += place.first[r.cloud];
    for (std::size_t c = 0; c < results.size(); ++c)
      if (c < all_.size())
        all_[c].add(minimum::of_pieces(results[c]));
      else
        all_.emplace_back(results[c]);
    result_ = std::move(piece);
  }
  typename Q::result result() {
    auto& results = Q::results(result_);
    for (std::size_t c = 0; c < results.size(); ++c) results[c] = all_[c].answer(scan::has_interior<PartView>);
    return std::move(result_);
  }

 private:
  std::vector<minimum::of_pieces> all_;
  typename Q::result result_;
};

}  // namespace plan

/// The least distance of each configuration. `poses` are world-from-part: one per part of the first configuration, then
/// those of the next; or a prepared question takes joint vectors of a `joint_chain`. It remembers where each
/// configuration's last minimum was. Refused: poses that are no whole configurations, d_max that is NaN, and radii as
/// in_collision.
struct min_distances {
  double d_max = infinity;  ///< Metres. For a configuration farther away only that fact is reported, much faster.
  std::vector<double> radii = {};  ///< By how much parts may be elsewhere, in metres: all alike, or each.

  using result = min_distances_result;
  using can = clearance::can<checking, joining, partial, planning, of_balls>;
  using searched = plan::least_question;
  static constexpr bool each_part = false;  ///< One result per configuration.
  template <class On, class PartView>
  using engine = plan::engine<On, PartView, min_distances>;
  template <class PartView>
  using joined = plan::joined_minima<min_distances, PartView>;

  void check(std::size_t parts) const {
    checked(parts);
    check_radii(radii, parts);
  }
  searched checked(std::size_t) const { return {frames::largest_within(d_max)}; }
  static arriving<min_distance_result>& results(result& r) { return r.of; }
  static void take_counts(result&, const point_counts&, std::size_t) {}
  static void so_far(result& r, std::uint64_t unseen) {
    for (min_distance_result& one : r.of) minimum::allow_for_unseen(one, unseen);
  }

  template <class On, class PartView, class Clouds>
  void ask_one(const On& on, const model_view<PartView>& model, std::span<const Eigen::Isometry3d> poses,
               const Clouds& clouds, result& r, std::size_t c) const {
    const real most = frames::largest_within(d_max);
    frames::frame_ahead ahead;
    const auto& frame = ahead.facts_of(model.facts, poses, clouds);
    r.of[c] = ask(on, model, poses, clouds, min_distance{});
    frames::cut(r.of[c], most, frame.slop, frame.error);
  }
};

}  // namespace clearance
