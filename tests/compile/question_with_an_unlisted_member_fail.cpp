// SPDX-License-Identifier: BSD-3-Clause
// expected-error: there is a member merge, but the list can<...> does not name merging
#include <clearance/concepts.hpp>

struct unlisted {
  using result = int;
  using can = clearance::can<clearance::partial>;
  template <class On, class PartView>
  class engine;

  static void merge(int& all, const int& other) { all += other; }
  static void so_far(int&, std::uint64_t) {}
};

static_assert(clearance::explain_question<unlisted>());
