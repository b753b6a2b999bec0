// SPDX-License-Identifier: BSD-3-Clause
// Stands for ranks.cpp where there is no MPI.
#include "command_line.hpp"
#include "ranks.hpp"

int on_all_ranks(const std::function<int(all_ranks&)>&) {
  throw usage_error("--shard", "this clearance was built without MPI");
}
