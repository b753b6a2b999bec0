// SPDX-License-Identifier: BSD-3-Clause
// expected-error: PointCloud2 coordinates are FLOAT32 or FLOAT64
#include <clearance/points/strided_points.hpp>

clearance::strided_points<int> records;
