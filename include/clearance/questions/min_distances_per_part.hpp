// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// How far is each part of many configurations of one robot from everything that its sensors see?

#include <clearance/ground/numbered.hpp>
#include <clearance/questions/min_distances.hpp>

namespace clearance {

/// The result of min_distance for each part alone, as min_distances gives it. of(c) are those of configuration c, one
/// per part.
struct min_distances_per_part_result {
  arriving<min_distance_result> all;
  std::size_t parts = 0;

  std::size_t size() const { return parts == 0 ? 0 : all.size() / parts; }
  /// The results of a configuration's parts. Throws std::out_of_range if there is no such configuration.
  std::span<const min_distance_result> of(std::size_t c) const& {
    check_number("configuration", c, size());
    return std::span(all).subspan(c * parts, parts);
  }
  /// A copy: a temporary result is gone before a view of it is read.
  std::vector<min_distance_result> of(std::size_t c) const&& {
    const auto its = of(c);
    return {its.begin(), its.end()};
  }
};

/// The least distance of each part of each configuration, otherwise as min_distances. Each part has its own bound, as a
/// robot of that part alone; all share one structure over the clouds.
struct min_distances_per_part {
  double d_max = infinity;         ///< Metres, as for min_distances.
  std::vector<double> radii = {};  ///< By how much parts may be elsewhere, in metres: all alike, or each.

  using result = min_distances_per_part_result;
  using can = clearance::can<checking, joining, partial, planning, of_balls>;
  using searched = plan::least_question;
  static constexpr bool each_part = true;
  template <class On, class PartView>
  using engine = plan::engine<On, PartView, min_distances_per_part>;
  template <class PartView>
  using joined = plan::joined_minima<min_distances_per_part, PartView>;

  void check(std::size_t parts) const {
    checked(parts);
    check_radii(radii, parts);
  }
  searched checked(std::size_t parts) const { return min_distances{d_max}.checked(parts); }
  static arriving<min_distance_result>& results(result& r) { return r.all; }
  static void take_counts(result& r, const point_counts&, std::size_t parts) { r.parts = parts; }
  static void so_far(result& r, std::uint64_t unseen) {
    for (min_distance_result& its : r.all) minimum::allow_for_unseen(its, unseen);
  }

  template <class On, class PartView, class Clouds>
  void ask_one(const On& on, const model_view<PartView>& model, std::span<const Eigen::Isometry3d> poses,
               const Clouds& clouds, result& all, std::size_t c) const {
    min_distances::result one;
    one.of.resize(1);
    for (std::size_t k = 0; k < model.size(); ++k) {
      min_distances{d_max}.ask_one(on, model.part(k), poses.subspan(k, 1), clouds, one, 0);
      min_distance_result& its = all.all[c * model.size() + k] = one.of[0];
      if (its.part != none) its.part = std::uint32_t(k);
    }
  }
};

}  // namespace clearance
