// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The contract of the library. A model of a concept lives in one header and includes this one.

#include <clearance/concepts/answer.hpp>
#include <clearance/concepts/backend.hpp>
#include <clearance/concepts/capsule.hpp>
#include <clearance/concepts/question.hpp>
#include <clearance/concepts/tally.hpp>
#include <clearance/concepts/traversal.hpp>
#include <clearance/concepts/tree.hpp>
#include <clearance/point_source.hpp>
