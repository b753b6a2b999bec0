// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The options that stand before or behind a --cloud.

#include "query_options.hpp"

/// Every option with its value, in the order of the command line.
std::vector<std::pair<std::string, std::string>> in_order(const CLI::App& app);

/// Throws usage_error if an option of one cloud is given twice for it. No value is read.
void check_given_once(const CLI::App& app);

/// The clouds in their order. An option before the first cloud goes to `all`, one after a cloud to that cloud.
std::vector<cloud_options> clouds_of(const CLI::App& app, cloud_options& all);
