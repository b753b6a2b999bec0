// SPDX-License-Identifier: BSD-3-Clause
// expected-error: the list can<...> names an ability that models of this kind do not have
#include <clearance/concepts.hpp>

struct settled_question {
  using result = int;
  using can = clearance::can<clearance::settling>;
  template <class On, class PartView>
  class engine;
};

static_assert(clearance::explain_question<settled_question>());
