// SPDX-License-Identifier: BSD-3-Clause
#include "unseen.hpp"

template clearance::unseen_result robot_on_backend<clearance::host>::unseen(poses_of, const clearance::unseen&, bool);
