// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/backend/device.cuh>
#include <clearance/backend/one_call.hpp>
#include <clearance/backend/stream_resource.cuh>

namespace clearance::detail {

/// Memory for one call comes in stream order.
template <>
struct one_call<device> {
  template <class Ask>
  static auto of(const device& on, const Ask& ask) {
    stream_resource memory(on.id, on.stream);
    return ask(&memory);
  }
};

}  // namespace clearance::detail
