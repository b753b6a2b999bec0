// SPDX-License-Identifier: BSD-3-Clause
// expected-error: deleted
#include <clearance/frames/clouds.hpp>

std::size_t points() { return clearance::placed{std::vector<clearance::vec3>(3)}.source.size(); }
