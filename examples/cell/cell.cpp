// SPDX-License-Identifier: BSD-3-Clause
#include "cell.hpp"

int main() { return example(clearance::host{}); }
