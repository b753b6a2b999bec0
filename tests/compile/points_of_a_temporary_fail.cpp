// SPDX-License-Identifier: BSD-3-Clause
// expected-error: deleted
#include <clearance/chunked_query.hpp>

std::size_t points() {
  clearance::chunked cloud(clearance::point_span(std::vector<clearance::vec3>(3)));
  return cloud.size();
}
