// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/zones.cuh>

#include "zones.hpp"

template clearance::zones_result robot_on_backend<clearance::device>::zones(poses_of, const clearance::zones_options&);
