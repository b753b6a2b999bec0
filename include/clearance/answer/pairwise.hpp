// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Answers that want every pair, once.

#include <clearance/result.hpp>
#include <clearance/visitor/nearest.hpp>

namespace clearance::pairwise {

/// As an answer of `scan_body`.
template <answer Answer>
struct each_pair {
  Answer answer;
  std::uint32_t cloud, first;

  CLEARANCE_HD real reach(std::uint32_t k) const { return answer.reach(k); }
  CLEARANCE_HD real reach_of_pair(std::uint32_t index, std::uint32_t k) const {
    if constexpr (settling_answer<Answer>)
      if (answer.settled(cloud, index - first, k)) return -infinity;
    return answer.reach(k);
  }
  CLEARANCE_HD bool settled(std::uint32_t, std::uint32_t) const { return false; }
  CLEARANCE_HD bool ended(std::uint32_t index) const
    requires ending_answer<Answer>
  {
    return answer.ended(cloud, index - first);
  }
  CLEARANCE_HD bool take_inside(std::uint32_t index, std::uint32_t k) const {
    if (answer.reach(k) >= 0) answer.take({cloud, index - first, k, none, 0});
    return false;
  }
  CLEARANCE_HD void take_certain() const {}
  CLEARANCE_HD nearest visitor(std::uint32_t, std::uint32_t k) const { return {answer.reach(k)}; }
  CLEARANCE_HD void take(std::uint32_t index, std::uint32_t k, const nearest& found) const {
    if (found.best != none) answer.take({cloud, index - first, k, found.best, found.within});
  }
};

}  // namespace clearance::pairwise
