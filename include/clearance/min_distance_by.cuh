// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A least distance with a deadline, on the host or on a device.

#include <clearance/backend/kept_pinned.cuh>
#include <clearance/backend/stream_resource.cuh>
#include <clearance/min_distance_by.hpp>
#include <clearance/min_distance_query.cuh>

namespace clearance::minimum {

template <>
struct timed_on<device> {
  static constexpr std::size_t piece = 1 << 22;
  template <robot Robot, class Ask>
  static auto with_query(const device& on, const Robot& robot, const Ask& ask) {
    stream_resource memory(on.id, on.stream);
    min_distance_query<device, typename decltype(view_of(robot))::part_type> query(on, robot, &memory, kept_pinned());
    try {
      return ask(query);
    } catch (...) {
      on.wait();  // the clouds before the one that was refused are written to pinned memory, which is kept for others
      throw;
    }
  }
};

}  // namespace clearance::minimum
