// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The k nearest points of each part, by counting distances in bins.

#include <clearance/pairwise/nearest_bins.hpp>
#include <clearance/pairwise/nearest_sample.hpp>
#include <clearance/questions/within.hpp>

#include <cmath>

namespace clearance {

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

namespace pairwise {

inline constexpr std::size_t most_listed = std::size_t(1) << 20;  ///< For one part.

/// Keeps the first `per_part` pairs of each part of `near`.
inline void take_nearest(nearest_k_result& all, const within_result& near) {
  all.pairs.clear();
  for (std::uint32_t p = 0; p + 1 < near.offsets.size(); ++p) {
    const auto begin = near.pairs.begin() + std::ptrdiff_t(near.offsets[p]);
    all.pairs.insert(all.pairs.end(), begin,
                     begin + std::ptrdiff_t(std::min(all.per_part, near.offsets[p + 1] - near.offsets[p])));
    all.pairs.resize((p + 1) * all.per_part, {none, none, p, none, infinity});
  }
}

/// All pairs within `radii`, one per part, in order. Clouds must be readable where the question runs.
template <class Passes, class Clouds>
within_result list_within(Passes& passes, std::span<const Eigen::Isometry3d> poses, const Clouds& clouds,
                          const std::vector<real>& radii) {
  const within question{{radii.begin(), radii.end()}};
  for (std::size_t least = 0;;) {
    const auto a = passes.look(poses, clouds);
    const within::out to = question.room(a, least);
    passes.enqueue(poses, clouds, question.prepare(a, to), to.counts);
    least = question.more(a, to);
    if (least == 0) return question.read(a, to);
  }
}

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
template <class Passes, class Clouds>
std::vector<real> bounds_of_nearest(Passes& passes, std::span<const Eigen::Isometry3d> poses, const Clouds& clouds,
                                    std::size_t k, real d_max) {
  std::vector<real> bounds(passes.model.size(), d_max);
  nearest_sample<std::remove_cvref_t<decltype(passes.on)>>::lower(passes, poses, clouds, k, bounds);
  return bounds;
}

/// How near the k nearest points of each part are: k points have at most that computed distance, or there are fewer
/// within d_max. Except for equal distances, not many more points do. `first` are the first bounds; if they are too low
/// and `again` allows it, everything is asked once more.
template <class Passes, class Clouds>
std::vector<real> radii_of_nearest(Passes& passes, std::span<const Eigen::Isometry3d> poses, const Clouds& clouds,
                                   std::uint32_t k, real d_max, const std::vector<real>& first, bool again) {
  const auto& on = passes.on;
  // A device passes over all points while a host copies and sorts some thousand pairs.
  constexpr std::size_t as_long = pairs_on<std::remove_cvref_t<decltype(on)>>::meets_points ? 1 << 11 : 1 << 16;
  const std::size_t parts = passes.model.size(), enough = 4 * k * parts + as_long;
  std::vector<nearest_window> windows;
  std::vector<std::uint32_t> bounds, before(parts);
  for (const real bound : first)
    bounds.push_back(ordered(bound)), windows.push_back({.wanted = k, .bound = bounds.back()});
  for (int pass = 0; pass < nearest_bins::passes; ++pass) {
    const int shift = nearest_bins::shift_of(pass);
    passes.memory.begin();
    std::uint32_t* const counts = passes.memory.template room<std::uint32_t>(parts * nearest_bins::bins).data();
    on.for_each(parts * nearest_bins::bins, zero_words{counts});
    const auto [there] = passes.memory.put(windows);
    passes.count(poses, clouds, nearest_bins{counts, there, shift});
    const std::vector<std::uint32_t> all = on.copy_out(counts, parts * nearest_bins::bins);
    std::size_t listed = 0;
    for (std::size_t p = 0; p < parts; ++p) {
      if (windows[p].wanted == 0) {
        listed += before[p];
        continue;
      }
      const wanted_bin found = next_window{all.data(), windows.data(), bounds.data(), shift}(p);
      if (found.bin == nearest_bins::bins && again && first[p] < d_max)
        return radii_of_nearest(passes, poses, clouds, k, d_max, bounds_of_nearest(passes, poses, clouds, k, d_max),
                                false);
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
template <class Passes, class Clouds>
nearest_k_result list_nearest(Passes& passes, known_nearest& known, std::span<const Eigen::Isometry3d> poses,
                              const Clouds& clouds, std::size_t k, real d_max) {
  const bool cold = k > known.k;
  const std::vector<real> first = cold ? bounds_of_nearest(passes, poses, clouds, k, d_max) : known.first_bounds(d_max);
  const std::vector<real> radii = radii_of_nearest(passes, poses, clouds, std::uint32_t(k), d_max, first, !cold);
  const within_result near = list_within(passes, poses, clouds, radii);
  nearest_k_result all;
  all.per_part = k;
  all.counts = near.counts, all.certain = near.certain;
  take_nearest(all, near);
  const bool lost =
      !std::equal(radii.begin(), radii.end(), first.begin(), [](real now, real before) { return now <= before; });
  if (k >= known.k || lost) known.learn(all);  // what is known of more is a bound for fewer, too
  return all;
}

}  // namespace pairwise

}  // namespace clearance
