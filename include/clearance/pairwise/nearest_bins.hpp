// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// How near each part's k nearest points are: an answer that counts the distances of pairs in bins.

#include <clearance/concepts.hpp>
#include <clearance/ground/ordered.hpp>

namespace clearance::pairwise {

/// What a pass knows of one part. Distances are `ordered` words, so that bins are fine at small distances.
struct nearest_window {
  std::uint32_t low = 0;       ///< The first bin begins here; smaller distances were counted before.
  std::uint32_t wanted = 0;    ///< So many are still to be found from `low` on; 0: nothing is asked about this part.
  std::uint32_t bound = 0;     ///< Farther points do not matter. It falls while points are counted.
  std::uint32_t taken = 0;     ///< Points in bins,
  std::uint32_t lowest = ~0u;  ///< and the first bin that has one.
};

/// An answer. Once enough points lie no farther than a bin's end, that end is a bound: farther points are none of the
/// nearest.
struct nearest_bins {
  using can = clearance::can<>;
  static constexpr std::uint32_t bins = 2048;
  static constexpr int passes = 3,
                       first_shift =
                           22;  ///< Two bins from a length to its double; then 2^11 in each; then one per number.
  static constexpr int shift_of(int pass) { return first_shift - 11 * pass; }

  std::uint32_t* counts;  ///< `bins` per part.
  nearest_window* windows;
  int shift;

  CLEARANCE_HD real reach(std::uint32_t part) const { return from_ordered(load_relaxed(&windows[part].bound)); }
  CLEARANCE_HD void take(const pair_distance& pair) const {
    nearest_window& w = windows[pair.part];
    std::uint32_t* const part_counts = counts + pair.part * std::size_t(bins);
    const std::uint32_t u = ordered(pair.distance);
    if (u < w.low || u > load_relaxed(&w.bound)) return;
    const std::uint32_t bin = (u - w.low) >> shift;
    if (bin >= bins) return;
    count_one(part_counts + bin);
    if (shift != first_shift) return;
    if (bin < load_relaxed(&w.lowest)) lower_word(&w.lowest, bin);
    const std::uint32_t taken = count_one(&w.taken) + 1;
    if (taken == w.wanted || (taken > w.wanted && taken % 64 == 0)) sharpen(w, part_counts);
  }

  /// No bin before it has a point, after the first pass.
  CLEARANCE_HD static std::uint32_t first_of(const nearest_window& w) { return w.lowest < bins ? w.lowest : 0; }
  /// The end of a bin, as a bound.
  CLEARANCE_HD static std::uint32_t end_of(std::uint32_t low, std::uint32_t bin, int shift) {
    return low + (bin << shift) + ((1u << shift) - 1);
  }

 private:
  /// Other threads may be adding to the counts. A count is at worst too small, and the bound too large.
  CLEARANCE_HD void sharpen(nearest_window& w, const std::uint32_t* part_counts) const {
    const std::uint32_t last = (load_relaxed(&w.bound) - w.low) >> shift;
    std::uint32_t sum = 0;
    for (std::uint32_t bin = load_relaxed(&w.lowest); bin < last; ++bin)
      if ((sum += load_relaxed(part_counts + bin)) >= w.wanted) return lower_word(&w.bound, end_of(w.low, bin, shift));
  }
};
static_assert(explain_answer<nearest_bins>());

struct zero_words {
  std::uint32_t* words;
  CLEARANCE_HD void operator()(std::size_t i) const { words[i] = 0; }
};

/// The bin of the wanted point (the number of bins if there are fewer points), and how many points lie before it.
/// No bin before `from` has one.
struct wanted_bin {
  std::uint32_t bin = 0, before = 0, count = 0;
};
CLEARANCE_HD inline wanted_bin find_wanted(const std::uint32_t* counts, std::uint32_t wanted, std::uint32_t from = 0) {
  wanted_bin found{from};
  for (; found.bin < nearest_bins::bins; ++found.bin) {
    found.count = counts[found.bin];
    if (found.before + std::uint64_t(found.count) >= wanted) return found;
    found.before += found.count;
  }
  found.count = 0;
  return found;
}

/// After a pass: sets part `p`'s window for the next one, and how near its k nearest points are.
struct next_window {
  const std::uint32_t* counts;
  nearest_window* windows;
  std::uint32_t* bounds;  ///< `ordered`, one per part.
  int shift;

  CLEARANCE_HD wanted_bin operator()(std::size_t p) const {
    nearest_window& w = windows[p];
    if (w.wanted == 0) return {nearest_bins::bins, 0, 0};
    const std::uint32_t from = shift == nearest_bins::first_shift ? nearest_bins::first_of(w) : 0;
    const wanted_bin found = find_wanted(counts + p * nearest_bins::bins, w.wanted, from);
    if (found.bin < nearest_bins::bins) {
      const std::uint32_t end = nearest_bins::end_of(w.low, found.bin, shift);
      if (end < bounds[p]) bounds[p] = end;
      w = {w.low + (found.bin << shift), w.wanted - found.before, bounds[p]};
    } else {
      w = {.bound = ordered(-infinity)};
    }
    return found;
  }
};

/// The same as a body for a backend.
struct decide_window {
  next_window next;
  CLEARANCE_HD void operator()(std::size_t p) const { next(p); }
};
/// Before the passes, and after them: distances as words, and words as distances.
struct open_windows {
  nearest_window* windows;
  std::uint32_t *bounds, wanted, bound;
  CLEARANCE_HD void operator()(std::size_t p) const {
    windows[p] = {.wanted = wanted, .bound = bound};
    bounds[p] = bound;
  }
};
/// After a pass over some of the points: the wanted one of those is a bound for the wanted one of all, and nothing is
/// counted yet.
struct keep_bound {
  const std::uint32_t* counts;
  nearest_window* windows;
  std::uint32_t *bounds, wanted;
  CLEARANCE_HD void operator()(std::size_t p) const {
    const std::uint32_t* const part_counts = counts + p * nearest_bins::bins;
    const wanted_bin found = find_wanted(part_counts, wanted, nearest_bins::first_of(windows[p]));
    if (found.bin < nearest_bins::bins) {
      const std::uint32_t end = nearest_bins::end_of(0, found.bin, nearest_bins::first_shift);
      if (end < bounds[p]) bounds[p] = end;
    }
    windows[p] = {.wanted = wanted, .bound = bounds[p]};
  }
};
struct bounds_as_reaches {
  const std::uint32_t* bounds;
  real* reaches;
  CLEARANCE_HD void operator()(std::size_t p) const { reaches[p] = from_ordered(bounds[p]); }
};

}  // namespace clearance::pairwise
