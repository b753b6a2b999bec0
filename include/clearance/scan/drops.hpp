// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Counts the points of a scan that are invalid, by reason.

#include <clearance/concepts.hpp>
#include <clearance/ground/ordered.hpp>

namespace clearance::scan {

/// How many points of a scan are invalid, by drop_reason.
struct drop_counts {
  unsigned long long dropped[drop_reasons] = {};
};

/// Computes how many points there were and how many are valid. `Counts`: point_counts, or a result with its members.
template <class Counts>
CLEARANCE_HD void count(Counts& r, const unsigned long long (&dropped)[drop_reasons], std::uint64_t seen) {
  r.seen = r.valid = seen;
  r.dropped[0] = 0;
  for (int k = 1; k < drop_reasons; ++k) {
    r.dropped[k] = dropped[k];
    r.valid -= dropped[k];
  }
}

/// What one thread met. It is added to the counts of all once.
struct drop_tally {
  std::uint32_t dropped[drop_reasons] = {};

  /// Is the point valid? If not, counts its reason.
  CLEARANCE_HD bool counts(const sample& s) {
    for (int r = 1; r < drop_reasons; ++r) dropped[r] += int(s.dropped) == r;
    return s.valid();
  }

  CLEARANCE_HD void add_to(drop_counts& all) const {
#if defined(__CUDA_ARCH__) && __CUDA_ARCH__ >= 800  // older devices have no such instruction
    // Once, before the loop, in which a lane may be ahead.
    const unsigned together = __activemask();
    const bool adds = (threadIdx.x & 31) == unsigned(__ffs(int(together)) - 1);
    for (int r = 1; r < drop_reasons; ++r) {
      const unsigned sum = __reduce_add_sync(together, dropped[r]);
      if (adds && sum != 0) add_to_word(&all.dropped[r], sum);
    }
#else
    for (int r = 1; r < drop_reasons; ++r)
      if (dropped[r] != 0) add_to_word(&all.dropped[r], dropped[r]);
#endif
  }

 private:
  CLEARANCE_HD static void add_to_word(unsigned long long* word, std::uint32_t n) { clearance::add_to(word, n); }
};

}  // namespace clearance::scan
