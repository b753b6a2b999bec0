// SPDX-License-Identifier: BSD-3-Clause
#include "self_filter.hpp"

int main() { return example(clearance::host{}); }
