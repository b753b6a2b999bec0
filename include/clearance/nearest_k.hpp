// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The k nearest points of each part. On the host; nearest_k.cuh has a device.

#include <clearance/answer/nearest_bins.hpp>
#include <clearance/within.hpp>

namespace clearance {

struct nearest_k_options {
  real d_max = infinity;  ///< Metres; farther points do not count.
};

/// Those of part k come from k * per_part on, the nearest first, then by cloud and point; where there are fewer, the others are at no point,
/// and infinitely far.
struct nearest_k_result {
  std::size_t per_part = 0;
  std::vector<pair_distance> pairs;
  point_counts counts;
  distance_certainty certain;  ///< Of each distance.

  std::span<const pair_distance> of(std::size_t part) const { return std::span(pairs).subspan(part * per_part, per_part); }
};

namespace detail {

/// How near the k nearest points of each part are: computed distances of k points are at most that, or there are not so many. Not many
/// more than k are, but for equal distances.
template <class On, robot Robot, class Clouds>
std::vector<real> radii_of_nearest(const On& on, const Robot& robot, std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, std::uint32_t k,
                                   real d_max) {
  using pairwise::nearest_bins, pairwise::nearest_window;
  const std::size_t parts = view_of(robot).size(), enough = 4 * k * parts + (1 << 16);
  std::vector<nearest_window> windows(parts, nearest_window{.wanted = k, .bound = ordered(d_max)});
  std::vector<std::uint32_t> bounds(parts, ordered(d_max)), before(parts);
  for (int pass = 0; pass < nearest_bins::passes; ++pass) {
    const int shift = nearest_bins::shift_of(pass);
    auto counts = on.template make_scratch<std::uint32_t>(parts * nearest_bins::bins);
    on.for_each(counts.size(), pairwise::zero_words{counts.data()});
    auto there = staged(on, windows);
    collect(on, robot, poses, clouds, nearest_bins{counts.data(), there.data(), shift});
    const std::vector<std::uint32_t> all = on.copy_out(counts.data(), counts.size());
    std::size_t listed = 0;
    for (std::size_t p = 0; p < parts; ++p) {
      nearest_window& w = windows[p];
      if (w.wanted == 0) {
        listed += before[p];
        continue;
      }
      const auto found = pairwise::find_wanted(std::span(all).subspan(p * nearest_bins::bins, nearest_bins::bins), w.wanted);
      const bool some = found.bin < nearest_bins::bins;
      if (some) bounds[p] = std::min(bounds[p], nearest_bins::end_of(w.low, found.bin, shift));
      w = some ? nearest_window{w.low + (found.bin << shift), w.wanted - found.before, bounds[p]} : nearest_window{.bound = ordered(-infinity)};
      before[p] += found.before;
      listed += before[p] + found.its;
    }
    if (listed <= enough) break;
  }
  std::vector<real> radii;
  for (const std::uint32_t bound : bounds) radii.push_back(from_ordered(bound));
  return radii;
}

}  // namespace detail

/// The k nearest points of each part (peers: kNN, top k): by computed distance, then cloud and point; a point may be in the lists of several
/// parts. `poses` and `clouds` as for min_distance; clouds that `on` cannot read are copied in each of two passes or more. Throws
/// std::invalid_argument as min_distance, and if k is 0 or above 2^20, or d_max is NaN.
template <class On, robot Robot, class Clouds>
nearest_k_result nearest_k(const On& on, const Robot& robot, std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, std::size_t k,
                           const nearest_k_options& options = {}) {
  static_assert(explain_clouds<Clouds>());
  if (k == 0 || k > (1 << 20)) throw std::invalid_argument("clearance: k is " + std::to_string(k) + "; it must be 1 to 2^20");
  if (!(options.d_max == options.d_max)) throw std::invalid_argument("clearance: d_max is not a number");
  const std::vector<real> radii = detail::radii_of_nearest(on, robot, poses, clouds, std::uint32_t(k), options.d_max);
  nearest_k_result all;
  all.per_part = k;
  const within_result near = within(on, robot, poses, clouds, std::span<const real>(radii));
  all.counts = near.counts, all.certain = near.certain;
  for (std::uint32_t p = 0; p < radii.size(); ++p) {
    all.pairs.insert(all.pairs.end(), near.pairs.begin() + std::ptrdiff_t(near.offsets[p]),
                     near.pairs.begin() + std::ptrdiff_t(std::min(near.offsets[p] + k, near.offsets[p + 1])));
    all.pairs.resize((p + 1) * k, {none, none, p, none, infinity});
  }
  return all;
}

}  // namespace clearance
