// SPDX-License-Identifier: BSD-3-Clause
#include "plan.hpp"

int main() { return example(clearance::host{}); }
