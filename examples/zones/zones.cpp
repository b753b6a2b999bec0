// SPDX-License-Identifier: BSD-3-Clause
#include "zones.hpp"

int main() { return example(clearance::host{}); }
