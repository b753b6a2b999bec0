// SPDX-License-Identifier: BSD-3-Clause
#include "motion.hpp"

int main() { return example(clearance::host{}); }
