# SPDX-License-Identifier: BSD-3-Clause
"""What a pickled robot is made with again."""


def robot(maker, *recipe):
    from ._core import Robot

    return getattr(Robot, maker)(*recipe)
