// SPDX-License-Identifier: BSD-3-Clause
// expected-error: a partial question needs: static void so_far(result& all, std::uint64_t unseen)
#include <clearance/concepts.hpp>

struct another {
  using result = int;
  template <class On, class PartView>
  class engine;

  static void so_far(int&) {}
};

static_assert(clearance::explain_question<another>());
