// SPDX-License-Identifier: BSD-3-Clause
// expected-error: a tally needs: bool ended(std::uint32_t index) const
#include <clearance/concepts/tally.hpp>
#include <clearance/visitor/nearest.hpp>

struct misspelt {
  CLEARANCE_HD clearance::real reach(std::uint32_t) const { return 0; }
  CLEARANCE_HD clearance::real reach_of_pair(std::uint32_t, std::uint32_t) const { return 0; }
  CLEARANCE_HD bool settled(std::uint32_t, std::uint32_t) const { return false; }
  CLEARANCE_HD bool touched(std::uint32_t, std::uint32_t) const { return false; }
  CLEARANCE_HD bool endet(std::uint32_t) const { return false; }
  CLEARANCE_HD bool foresees(std::uint32_t, std::uint32_t, clearance::vec3, bool, clearance::nearest&) const {
    return false;
  }
  CLEARANCE_HD bool take_inside(std::uint32_t, std::uint32_t) const { return false; }
  CLEARANCE_HD void take_certain() const {}
  CLEARANCE_HD clearance::nearest visitor(std::uint32_t, std::uint32_t) const { return {0}; }
  CLEARANCE_HD void take(std::uint32_t, std::uint32_t, const clearance::nearest&) const {}
};

static_assert(clearance::explain_tally<misspelt>());
