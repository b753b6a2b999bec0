// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The numbers that one thread goes through.

#include <clearance/ground/config.hpp>

#include <cstddef>

namespace clearance {

/// begin, begin + step, ... below end: a block of points on the host, a grid stride on the device.
struct indices {
  std::size_t begin, end, step;
};

}  // namespace clearance
