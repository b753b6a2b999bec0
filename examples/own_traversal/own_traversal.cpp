// SPDX-License-Identifier: BSD-3-Clause
#include "own_traversal.hpp"

#include <clearance/backends/host.hpp>

int main() { return example(clearance::host{}); }
