# SPDX-License-Identifier: BSD-3-Clause
# Nothing is needed at run time here.
