// SPDX-License-Identifier: BSD-3-Clause
// expected-error: a merging question needs: static void merge(result& all, const result& other)
#include <clearance/concepts.hpp>

struct returning {
  using result = int;
  template <class On, class PartView>
  class engine;

  static int merge(int all, const int& other) { return all + other; }
};

static_assert(clearance::explain_question<returning>());
