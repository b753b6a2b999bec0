// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The k nearest points of each part.

#include <clearance/questions/nearest_points.hpp>

namespace clearance {

/// The k nearest points of each part (elsewhere: kNN, top k): by computed distance, then cloud and point; a point may
/// be in the lists of several parts. Refused: k of 0 or above 2^20, and d_max that is NaN.
struct nearest_k {
  std::size_t k = 1;
  double d_max = infinity;  ///< Metres; farther points do not count.

  using result = nearest_k_result;
  using can = clearance::can<checking, numbering, merging>;
  /// Enqueued, the backend decides how near the k nearest points of each part are, and lists all pairs that are as
  /// near, in any order: k for each part, fewer if there are fewer, and more if some are equally far as the k-th.
  /// `count` becomes how many there are: if that is more than `capacity`, some were cut.
  using out = within::out;

  /// One call remembers how near the nearest points were, which only makes the next one faster.
  template <class On, class PartView>
  class engine {
   public:
    template <class... Memory>
    engine(const On& on, const model_view<PartView>& model, Memory... from) : passes_(on, model, from...) {}

    /// What one pass finds decides what the next one asks.
    static constexpr bool waits = true;
    template <class Clouds>
    void begin(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const nearest_k& q) {
      q.check();
      result_ = pairwise::list_nearest(passes_, known_, poses, passes_.readable(clouds), q.k,
                                       frames::largest_within(q.d_max));
    }
    result finish() { return std::move(result_); }
    template <class Clouds>
    distance_certainty start(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const nearest_k& q,
                             const out& to) {
      q.check();
      using pairwise::nearest_bins;
      const real d_max = frames::largest_within(q.d_max);
      const auto a = passes_.prepare(poses, clouds);
      const std::size_t parts = a.parts(), bins = parts * nearest_bins::bins;
      auto* const counts = a.template space<std::uint32_t>(bins);
      auto* const windows = a.template space<pairwise::nearest_window>(parts);
      auto* const bounds = a.template space<std::uint32_t>(parts);
      auto* const reaches = a.template space<real>(parts);
      pairwise::sample_bounds(passes_, poses, clouds, a.points,
                              nearest_bins{counts, windows, nearest_bins::shift_of(0)}, bounds, std::uint32_t(q.k),
                              d_max, to.counts);
      for (int pass = 0; pass < nearest_bins::passes; ++pass) {
        const int shift = nearest_bins::shift_of(pass);
        a.on.for_each(bins, pairwise::zero_words{counts});
        passes_.enqueue(poses, clouds, nearest_bins{counts, windows, shift}, to.counts);
        a.on.for_each(parts, pairwise::decide_window{{counts, windows, bounds, shift}});
      }
      a.on.for_each(parts, pairwise::bounds_as_reaches{bounds, reaches});
      const unsigned long long nothing = 0;
      a.on.stage(std::span(&nothing, 1), to.count);
      passes_.enqueue(poses, clouds, pairwise::listed{to.pairs, to.count, to.capacity, reaches}, to.counts);
      return a.certain();
    }
    /// Forgets the last frame. The next one starts cold; its answer is the same.
    void forget() { known_ = {}; }

   private:
    pairwise::passes<On, PartView> passes_;
    pairwise::known_nearest known_;
    result result_;
  };

  void check() const {
    if (k == 0 || k > pairwise::most_listed)
      throw std::invalid_argument("clearance: k is " + std::to_string(k) + "; it must be 1 to 2^20");
    frames::largest_within(d_max);
  }

  static void place_in_whole(result& r, const piece_place& place) {
    for (pair_distance& pair : r.pairs)
      if (pair.cloud != none) pair.point += place.first[pair.cloud];
  }
  static void merge(result& whole, const result& other) {
    within_result both;
    const std::size_t parts = whole.per_part == 0 ? 0 : whole.pairs.size() / whole.per_part;
    for (const auto from : {std::span<const pair_distance>(whole.pairs), std::span<const pair_distance>(other.pairs)})
      for (const pair_distance& pair : from)
        if (pair.cloud != none) both.pairs.push_back(pair);
    pairwise::put_in_order(both, parts);
    pairwise::take_nearest(whole, both);
    whole.counts.add(other.counts);
    whole.certain.widen(other.certain);
  }
};

}  // namespace clearance
