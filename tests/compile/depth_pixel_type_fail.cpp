// SPDX-License-Identifier: BSD-3-Clause
// expected-error: depth pixels are 16-bit integers or floats
#include <clearance/points/depth_image.hpp>

clearance::depth_image<double> image;
