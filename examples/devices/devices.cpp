// SPDX-License-Identifier: BSD-3-Clause
#include "devices.hpp"

int main() { return example(clearance::host{}, wall()); }
