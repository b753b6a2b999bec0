// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/io/cloud_file.hpp>
