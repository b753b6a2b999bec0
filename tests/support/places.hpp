// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Where things lie on this machine. They are compiled once, so that no other test's objects depend on paths.

#include <string>

namespace testing {

/// In the folder of real robots, depth frames and malformed files; it may not be there.
std::string data(const std::string& below = {});
/// In this repository.
std::string checkout(const std::string& below);
/// The clearance command.
std::string command();

}  // namespace testing
