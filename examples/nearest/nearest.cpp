// SPDX-License-Identifier: BSD-3-Clause
#include "nearest.hpp"

int main() { return example(clearance::host{}); }
