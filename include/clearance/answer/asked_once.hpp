// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// One call of a question that could be prepared.

#include <clearance/backend/one_call.hpp>
#include <clearance/robot/model.hpp>

namespace clearance::pairwise {

/// Makes a `Query` for one call and returns `ask(query)`. The query's memory is given back in the order of its work.
template <template <class, class> class Query, class On, robot Robot, class Ask>
auto asked_once(const On& on, const Robot& robot, const Ask& ask) {
  return detail::one_call<On>::of(on, [&](auto... memory) {
    Query<On, typename decltype(view_of(robot))::part_type> query(on, robot, memory...);
    return ask(query);
  });
}

}  // namespace clearance::pairwise
