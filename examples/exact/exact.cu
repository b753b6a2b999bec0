// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/signed_distances.cuh>  // a device's scan

#include "exact.hpp"

int main() { return example(clearance::device{}); }
