// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Every pair of a point and a part that is near enough, for an answer of your own.

#include <clearance/query/query.hpp>

namespace clearance {

/// Gives `answer`, a view of memory that the backend writes, every pair within its reach. The result is the counts of
/// points. A question of your own (concepts/question.hpp) also makes its own result, and has more forms.
template <answer Answer>
struct collect {
  Answer answer;

  using result = point_counts;
  using can = clearance::can<>;
  struct out {
    point_counts* counts;
  };

  template <class Asked>
  out space(const Asked& a) const {
    return {a.template space<point_counts>(1)};
  }
  template <class Asked>
  Answer prepare(const Asked&, const out&) const {
    return answer;
  }
  template <class Asked>
  result read(const Asked& a, const out& from) const {
    return a.copy_out(from.counts, 1)[0];
  }
};
template <class Answer>
collect(Answer) -> collect<Answer>;

}  // namespace clearance
