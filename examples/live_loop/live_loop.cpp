// SPDX-License-Identifier: BSD-3-Clause
#include "live_loop.hpp"

#include <clearance/backend/host.hpp>

int main() { return example(clearance::host{}); }
