// SPDX-License-Identifier: BSD-3-Clause
#include "uncertain.hpp"

int main() { return example(clearance::host{}); }
