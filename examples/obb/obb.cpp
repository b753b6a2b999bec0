// SPDX-License-Identifier: BSD-3-Clause
#include "obb.hpp"

#include <clearance/backends/host.hpp>

int main() { return example(clearance::host{}); }
