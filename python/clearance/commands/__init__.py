# SPDX-License-Identifier: BSD-3-Clause
"""Subcommands: one in each file."""
