// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/backend/host.hpp>
#include <clearance/packing/climb.hpp>

/// What packing in rounds needs besides a backend, on the host: so the device's algorithm is tested without a device.
struct host_steps {
  clearance::host on;

  template <class F>
  std::size_t select(std::size_t n, F f, std::uint32_t* out) const {
    std::vector<char> holds(n);  // as on the device, f is called for all before any is written
    on.for_each(n, [&](std::size_t i) { holds[i] = f(i); });
    std::size_t count = 0;
    for (std::size_t i = 0; i < n; ++i)
      if (holds[i]) out[count++] = std::uint32_t(i);
    return count;
  }
  template <class F>
  double largest(std::size_t n, F f) const {
    double most = 0;
    for (std::size_t i = 0; i < n; ++i) most = std::max(most, f(i));
    return most;
  }
  template <class F>
  void climbers(std::size_t n, F f) const {
    on.for_each(n, [&](std::size_t i) { f(i, clearance::one_lane{}); });
  }
};
