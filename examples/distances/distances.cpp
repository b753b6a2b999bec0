// SPDX-License-Identifier: BSD-3-Clause
#include "distances.hpp"

int main() { return example(clearance::host{}); }
