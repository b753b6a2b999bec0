// SPDX-License-Identifier: BSD-3-Clause
#include "deadline.hpp"

int main() { return example(clearance::host{}); }
