// SPDX-License-Identifier: BSD-3-Clause
// expected-error: a visitor needs: CLEARANCE_HD void offer(std::uint32_t id, real distance)
#include <clearance/concepts.hpp>

struct counter {
  using result_type = int;
  CLEARANCE_HD clearance::real reach() const { return 0; }
  CLEARANCE_HD int result() const { return 0; }
};

static_assert(clearance::explain_visitor<counter>());
