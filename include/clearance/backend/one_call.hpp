// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace clearance::detail {

/// A prepared question that is made for one call. What `ask(memory...)` answers: on a device (one_call.cuh) it is told
/// of a resource.
template <class On>
struct one_call {
  template <class Ask>
  static auto of(const On&, const Ask& ask) {
    return ask();
  }
};

}  // namespace clearance::detail
