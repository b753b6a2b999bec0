// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/device.cuh>
#include <clearance/questions/unseen.hpp>

#include "unseen.hpp"

template clearance::unseen_result robot_on_backend<clearance::device>::unseen(poses_of, const clearance::unseen&, bool);
