// SPDX-License-Identifier: BSD-3-Clause
#include "near.hpp"

int main() { return example(clearance::host{}); }
