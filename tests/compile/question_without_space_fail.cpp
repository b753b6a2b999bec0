// SPDX-License-Identifier: BSD-3-Clause
// expected-error: a question needs, or an engine: template <class Asked> out space(const Asked&) const
#include <clearance/concepts.hpp>

struct homeless {
  using result = int;
  struct out {
    int* pairs;
  };
  template <class Asked>
  int prepare(const Asked&, const out&) const;
  template <class Asked>
  int read(const Asked&, const out&) const;
};

static_assert(clearance::explain_question<homeless>());
