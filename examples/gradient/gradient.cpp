// SPDX-License-Identifier: BSD-3-Clause
#include "gradient.hpp"

int main() { return example(clearance::host{}); }
