// SPDX-License-Identifier: BSD-3-Clause
#include "exact.hpp"

int main() { return example(clearance::host{}); }
