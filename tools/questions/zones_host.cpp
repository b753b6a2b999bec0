// SPDX-License-Identifier: BSD-3-Clause
#include "zones.hpp"

template clearance::zones_result robot_on_backend<clearance::host>::zones(poses_of, const clearance::zones_options&);
