// SPDX-License-Identifier: BSD-3-Clause
#include "ask.hpp"

answer ask_host(const question& asked) { return ask(clearance::host{}, asked); }
