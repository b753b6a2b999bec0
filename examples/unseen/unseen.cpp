// SPDX-License-Identifier: BSD-3-Clause
#include "unseen.hpp"

int main() { return example(clearance::host{}); }
