// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Where a question that is asked once gets its memory.

namespace clearance::detail {

/// For a prepared question made for one call: returns `ask(memory...)`. On a device (one_call.cuh) that is a resource.
template <class On>
struct one_call {
  template <class Ask>
  static auto of(const On&, const Ask& ask) {
    return ask();
  }
};

}  // namespace clearance::detail
