// SPDX-License-Identifier: BSD-3-Clause
#include "ask.hpp"

reply ask_host(const question& asked) { return ask(clearance::host{}, asked); }

std::unique_ptr<prepared_question> prepare_host(const question& asked) { return prepare(clearance::host{}, asked); }
