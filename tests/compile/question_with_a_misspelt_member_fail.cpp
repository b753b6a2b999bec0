// SPDX-License-Identifier: BSD-3-Clause
// expected-error: a merging question needs: static void merge(result& all, const result& other)
#include <clearance/concepts.hpp>

struct misspelt {
  using result = int;
  using can = clearance::can<clearance::merging>;
  template <class On, class PartView>
  class engine;

  static void merg(int& all, const int& other) { all += other; }
};

static_assert(clearance::explain_question<misspelt>());
