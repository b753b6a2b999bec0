// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The k nearest points of each part. Runs on the host; include nearest_k.cuh for a device.

#include <clearance/answer/nearest_bins.hpp>
#include <clearance/answer/nearest_sample.hpp>
#include <clearance/within.hpp>

#include <cmath>

namespace clearance {

struct nearest_k_options {
  real d_max = infinity;  ///< Metres; farther points do not count.
};

/// The pairs of part k begin at k * per_part, the nearest first, then by cloud and point. If there are fewer, the rest
/// is at no point, and infinitely far.
struct nearest_k_result {
  std::size_t per_part = 0;
  std::vector<pair_distance> pairs;
  point_counts counts;
  distance_certainty certain;  ///< Of each distance.

  std::span<const pair_distance> of(std::size_t part) const {
    return std::span(pairs).subspan(part * per_part, per_part);
  }
};

namespace detail {

inline constexpr std::size_t most_listed = std::size_t(1) << 20;  ///< For one part.

/// What the last frame says about the next: how near the k nearest may still be. It is only a first bound; if fewer
/// points are so near, everything is asked again.
struct known_nearest {
  std::size_t k = 0;
  std::vector<real> last, radii;  ///< One per part: how near the last of k was, and a bound for the next frame.

  /// Bounds for at most k points.
  std::vector<real> first_bounds(real d_max) const {
    std::vector<real> first = radii;
    for (real& bound : first) bound = std::min(d_max, bound);
    return first;
  }
  /// In the next frame they may be farther by twice as much as they have moved, and 5 mm; at first by a tenth
  /// and 2 cm.
  void learn(const nearest_k_result& found) {
    std::vector<real> now, next;
    for (std::size_t p = 0; p * found.per_part < found.pairs.size(); ++p) {
      now.push_back(found.of(p).back().distance);
      const bool moved = k == found.per_part && now[p] < infinity && last[p] < infinity;
      next.push_back(now[p] + (moved ? 2 * std::abs(now[p] - last[p]) + 0.005f : std::abs(now[p]) / 10 + 0.02f));
    }
    last = std::move(now), radii = std::move(next), k = found.per_part;
  }
};

/// First bounds, if no frame before is known.
template <class Question, class Clouds>
std::vector<real> bounds_of_nearest(Question& question, std::span<const Eigen::Isometry3d> poses, const Clouds& clouds,
                                    std::size_t k, real d_max) {
  std::vector<real> bounds(question.model.size(), d_max);
  pairwise::nearest_sample<std::remove_cvref_t<decltype(question.on)>>::lower(question.on, question.model, poses,
                                                                              clouds, k, bounds);
  return bounds;
}

/// How near the k nearest points of each part are: k points have at most that computed distance, or there are fewer
/// within d_max. Except for equal distances, not many more points do. `first` are the first bounds; if they are too low
/// and `again` allows it, everything is asked once more.
template <class Question, class Clouds>
std::vector<real> radii_of_nearest(Question& question, std::span<const Eigen::Isometry3d> poses, const Clouds& clouds,
                                   std::uint32_t k, real d_max, const std::vector<real>& first, bool again) {
  using pairwise::nearest_bins, pairwise::nearest_window;
  const auto& on = question.on;
  const std::size_t parts = question.model.size(), enough = 4 * k * parts + (1 << 16);
  std::vector<nearest_window> windows;
  std::vector<std::uint32_t> bounds, before(parts);
  for (const real bound : first)
    bounds.push_back(ordered(bound)), windows.push_back({.wanted = k, .bound = bounds.back()});
  for (int pass = 0; pass < nearest_bins::passes; ++pass) {
    const int shift = nearest_bins::shift_of(pass);
    question.memory.begin();
    std::uint32_t* const counts = question.memory.template room<std::uint32_t>(parts * nearest_bins::bins).data();
    on.for_each(parts * nearest_bins::bins, pairwise::zero_words{counts});
    const auto [there] = question.memory.put(windows);
    question.count(poses, clouds, nearest_bins{counts, there, shift});
    const std::vector<std::uint32_t> all = on.copy_out(counts, parts * nearest_bins::bins);
    std::size_t listed = 0;
    for (std::size_t p = 0; p < parts; ++p) {
      nearest_window& w = windows[p];
      if (w.wanted == 0) {
        listed += before[p];
        continue;
      }
      const auto found =
          pairwise::find_wanted(std::span(all).subspan(p * nearest_bins::bins, nearest_bins::bins), w.wanted);
      const bool some = found.bin < nearest_bins::bins;
      if (!some && again && first[p] < d_max)
        return radii_of_nearest(question, poses, clouds, k, d_max, bounds_of_nearest(question, poses, clouds, k, d_max),
                                false);
      if (some) bounds[p] = std::min(bounds[p], nearest_bins::end_of(w.low, found.bin, shift));
      w = some ? nearest_window{w.low + (found.bin << shift), w.wanted - found.before, bounds[p]}
               : nearest_window{.bound = ordered(-infinity)};
      before[p] += found.before;
      listed += before[p] + found.its;
    }
    if (listed <= enough) break;
  }
  std::vector<real> radii;
  for (const std::uint32_t bound : bounds) radii.push_back(from_ordered(bound));
  return radii;
}

/// Clouds must be readable where the question runs.
template <class Question, class Clouds>
nearest_k_result list_nearest(Question& question, known_nearest& known, std::span<const Eigen::Isometry3d> poses,
                              const Clouds& clouds, std::size_t k, real d_max) {
  if (k == 0 || k > most_listed)
    throw std::invalid_argument("clearance: k is " + std::to_string(k) + "; it must be 1 to 2^20");
  if (!(d_max == d_max)) throw std::invalid_argument("clearance: d_max is not a number");
  const bool cold = k > known.k;
  const std::vector<real> first =
      cold ? bounds_of_nearest(question, poses, clouds, k, d_max) : known.first_bounds(d_max);
  const std::vector<real> radii = radii_of_nearest(question, poses, clouds, std::uint32_t(k), d_max, first, !cold);
  nearest_k_result all;
  all.per_part = k;
  const within_result near = list_within(question, poses, clouds, radii);
  all.counts = near.counts, all.certain = near.certain;
  for (std::uint32_t p = 0; p < radii.size(); ++p) {
    all.pairs.insert(all.pairs.end(), near.pairs.begin() + std::ptrdiff_t(near.offsets[p]),
                     near.pairs.begin() + std::ptrdiff_t(std::min(near.offsets[p] + k, near.offsets[p + 1])));
    all.pairs.resize((p + 1) * k, {none, none, p, none, infinity});
  }
  const bool lost =
      !std::equal(radii.begin(), radii.end(), first.begin(), [](real now, real before) { return now <= before; });
  if (k >= known.k || lost) known.learn(all);  // what is known of more is a bound for fewer, too
  return all;
}

}  // namespace detail

/// The prepared question: make it once for a robot, and ask it in every frame with new poses, points and k. It
/// remembers how near the nearest points were, which only makes it faster. It cannot be enqueued: the host decides by
/// the counts of one pass whether there is another, and how much is listed. Use one object from one thread and one
/// stream; the robot must outlive it.
template <class On, class PartView>
class nearest_k_query {
 public:
  /// `memory` is for a device only: a std::pmr::memory_resource* that hands out device memory.
  template <robot Robot, class... Memory>
  nearest_k_query(const On& on, const Robot& robot, Memory... memory) : question_(on, view_of(robot), memory...) {}

  /// As `nearest_k`. Points that a device cannot read are copied into buffers that it keeps.
  template <class Clouds>
  nearest_k_result operator()(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, std::size_t k,
                              const nearest_k_options& options = {}) {
    static_assert(explain_clouds<Clouds>());
    return detail::list_nearest(question_, known_, poses, question_.memory.readable(clouds), k, options.d_max);
  }

  /// Forgets the last frame. The next one starts cold; its answer is the same.
  void forget() { known_ = {}; }

 private:
  pairwise::pair_question<On, PartView> question_;
  detail::known_nearest known_;
};
template <class On, robot Robot, class... Memory>
nearest_k_query(const On&, const Robot&, Memory...)
    -> nearest_k_query<On, typename decltype(view_of(std::declval<const Robot&>()))::part_type>;

/// The k nearest points of each part (elsewhere: kNN, top k): by computed distance, then cloud and point; a point may
/// be in the lists of several parts. `poses` and `clouds` as for min_distance. Throws std::invalid_argument as
/// min_distance, and if k is 0 or above 2^20, or d_max is NaN.
template <class On, robot Robot, class Clouds>
nearest_k_result nearest_k(const On& on, const Robot& robot, std::span<const Eigen::Isometry3d> poses,
                           const Clouds& clouds, std::size_t k, const nearest_k_options& options = {}) {
  return pairwise::asked_once<nearest_k_query>(on, robot,
                                               [&](auto& query) { return query(poses, clouds, k, options); });
}

}  // namespace clearance
