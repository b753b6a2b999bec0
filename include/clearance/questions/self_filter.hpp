// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Which points are the robot itself?

#include <clearance/pairwise/own_points.hpp>
#include <clearance/pointwise/joined_points.hpp>
#include <clearance/query/query.hpp>

#include <cmath>

namespace clearance {

/// Whose each point is. A point is the robot's if it is certainly within the padding of a part's solid. If gap,
/// tolerance or rounding leave that open, it is `uncertain` and not hidden: a point hidden wrongly may be an obstacle,
/// a point kept wrongly stops a robot. Without a certificate every other point is uncertain.
struct self_filter_result {
  std::vector<point_label> labels;   ///< One per point of all clouds, in their order.
  std::vector<std::size_t> offsets;  ///< The labels of cloud c are offsets[c] to offsets[c + 1] - 1.
  std::vector<std::uint32_t> rest;   ///< The numbers of all valid points that are not hidden, ascending.
  self_filter_counts counts;
};

namespace pairwise {

/// How near points must be to each part to be perhaps the robot's, and certainly. True if all others are uncertain, so
/// that nobody need ask which.
inline bool set_paddings(std::span<const double> padding, std::span<const part_facts> facts,
                         const frames::float_error& error, std::vector<real>& reaches) {
  const std::size_t given = padding.size(), parts = facts.size();
  if (given != 1 && given != parts)
    throw std::invalid_argument("clearance: there are " + std::to_string(parts) + " parts, but " +
                                std::to_string(given) + " paddings");
  reaches.resize(2 * parts);
  bool all_uncertain = false;
  for (std::size_t k = 0; k < parts; ++k) {
    const double its = padding[given == 1 ? 0 : k];
    if (!(its >= 0 && its < double(infinity)))
      throw std::invalid_argument("clearance: the padding of part " + std::to_string(k) + " is " + std::to_string(its) +
                                  " m; it must be finite, and not negative");
    reaches[parts + k] = frames::is_within(its, facts[k], error);
    reaches[k] = frames::may_be_within(its, facts[k], error);
    if (!(reaches[k] < infinity)) all_uncertain = true, reaches[k] = reaches[parts + k];
  }
  return all_uncertain;
}

/// Numbers of the valid points that are not hidden.
inline void list_rest(self_filter_result& r) {
  r.rest.clear();
  r.rest.reserve(std::size_t(r.counts.points.valid - r.counts.own));
  for (std::size_t i = 0; i < r.labels.size(); ++i)
    if (r.labels[i] == point_label::rest || r.labels[i] == point_label::uncertain) r.rest.push_back(std::uint32_t(i));
}

template <class Q>
class joined_labels {
 public:
  joined_labels(const Q&, std::span<const part_facts>) {}

  void add(const self_filter_result& piece, const piece_place& place) {
    pointwise::place_entries(piece.labels, place, all_.labels);
    all_.counts.points.add(piece.counts.points);
    all_.counts.own += piece.counts.own, all_.counts.uncertain += piece.counts.uncertain;
    all_.offsets = {0};
    for (const std::uint32_t size : place.whole) all_.offsets.push_back(all_.offsets.back() + size);
  }
  self_filter_result result() {
    list_rest(all_);
    return std::move(all_);
  }

 private:
  self_filter_result all_;
};

}  // namespace pairwise

/// Which points are the robot itself? Refused: neither one nor as many paddings as parts, and one that is negative or
/// not finite.
struct self_filter {
  /// Metres around a part that belong to the robot: one number for all parts, or one per part. It has to cover the
  /// error of points on the robot's surface: noise, calibration, and the gap of the part's spheres.
  std::vector<double> padding = {0.01};

  using result = self_filter_result;
  /// One label per point of all clouds, in memory that the backend writes. The next work in a stream may ask about
  /// `masked_clouds(clouds, labels)`.
  struct out {
    point_label* labels;
    self_filter_counts* counts;
  };
  template <class PartView>
  using joined = pairwise::joined_labels<self_filter>;

  template <class Asked>
  out room(const Asked& a) const {
    return {a.template room<point_label>(a.points), a.template room<self_filter_counts>(1)};
  }
  static point_counts* counts_of(const out& to) { return &to.counts->points; }
  template <class Asked, class Clouds>
  pairwise::own_points prepare(const Asked& a, const out& to, const Clouds& clouds) const {
    using answer = pairwise::own_points;
    for_each_cloud(clouds, []<point_source S>(const S&, const Eigen::Isometry3d&) {
      static_assert(points_alone<S>());  // what may be elsewhere is not certainly the robot's
    });
    const bool all_uncertain = pairwise::set_paddings(padding, a.facts, a.frame.error, a.reaches);
    const auto near = backends::few_or_kept<2 * pairwise::paddings::few>(a.reaches, a.memory);
    const auto start = backends::few_or_kept<answer::few_clouds>(a.first, a.memory);
    const answer own{to.labels, to.counts, {near, std::uint32_t(a.parts())}, start, all_uncertain};
    if constexpr (!Asked::meets_points) {
      a.on.for_each(1, pairwise::forget_labels{to.counts});
      std::uint32_t cloud = 0;
      for_each_cloud(clouds, [&]<point_source S>(const S& source, const Eigen::Isometry3d&) {
        a.on.for_each(source.size(), pairwise::label_alone<S>{own, source, cloud++});
      });
    }
    return own;
  }
  template <class Asked>
  void conclude(const Asked& a, const pairwise::own_points& own, const out&) const {
    if constexpr (!Asked::meets_points) a.on.for_each(a.points, pairwise::count_labels{own});
  }
  template <class Asked>
  result read(const Asked& a, const out& from) const {
    result all;
    all.labels = a.copy_out(from.labels, a.points);
    all.counts = a.copy_out(from.counts, 1)[0];
    all.offsets.assign(a.first.begin(), a.first.begin() + std::ptrdiff_t(a.clouds));
    all.offsets.push_back(a.points);
    pairwise::list_rest(all);
    return all;
  }
};

}  // namespace clearance
