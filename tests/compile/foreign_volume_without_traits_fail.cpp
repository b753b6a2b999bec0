// SPDX-License-Identifier: BSD-3-Clause
// expected-error: a bounding volume V needs: static V fit(std::span<const ball>), as a member or in bounding_volume_traits<V>
#include <clearance/concepts.hpp>

// A foreign volume that has not been taught to the library yet.
struct their_box {
  float lower[3], upper[3];
};

static_assert(clearance::explain_bounding_volume<their_box>());
