# SPDX-License-Identifier: BSD-3-Clause
"""What makes a pickled robot, cloud or camera again."""


def robot(maker, *recipe):
    from ._core import Robot

    return getattr(Robot, maker)(*recipe)


def cloud(maker, arguments, named):
    from . import _core

    return getattr(_core, maker)(*arguments, **named)


def camera(width, height, k, d, distortion_model, binning, roi):
    from ._core import Camera

    return Camera(width, height, k, d, distortion_model, binning=binning, roi=roi)
