// SPDX-License-Identifier: BSD-3-Clause
#include "places.hpp"

std::string testing::data(const std::string& below) { return CLEARANCE_TEST_DATA + below; }
std::string testing::checkout(const std::string& below) { return CLEARANCE_TEST_ROOT "/" + below; }
#if defined(CLEARANCE_COMMAND)
std::string testing::command() { return CLEARANCE_COMMAND; }
#endif
