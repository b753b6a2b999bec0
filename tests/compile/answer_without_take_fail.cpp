// SPDX-License-Identifier: BSD-3-Clause
// expected-error: an answer needs: CLEARANCE_HD void take(const pair_distance&) const
#include <clearance/concepts.hpp>

struct deaf {
  CLEARANCE_HD clearance::real reach(std::uint32_t) const { return 0; }
};

static_assert(clearance::explain_answer<deaf>());
