// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Which traversal walks a robot's trees, where no kernel of the library does.

#include <clearance/backends/host.hpp>
#include <clearance/robot/model.hpp>
#include <clearance/traversal/any_depth.hpp>

namespace clearance::scan {

/// The traversal of `plain`, or nearest first. Throws std::invalid_argument if a tree is too deep for its stack, or for
/// the call stack of a device.
template <class On, class PartView>
auto walk_of(const On& on, const model_view<PartView>& model) {
  if constexpr (requires { on.walk; }) {
    using walk_type = std::remove_const_t<decltype(on.walk)>;
    check_stack<walk_type>(model.depth, model.width);
    if constexpr (recursing_traversal<walk_type> && requires { on.check_call_stack(std::size_t(0)); })
      on.check_call_stack(walk_type::device_stack(model.depth));
    return on.walk;
  } else {
    if constexpr (!std::is_base_of_v<host, On>) check_stack<near_first>(model.depth, model.width);
    return any_depth{stack_need(model.depth, model.width)};
  }
}

}  // namespace clearance::scan
