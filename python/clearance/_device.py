# SPDX-License-Identifier: BSD-3-Clause
"""The way to the GPU part, which is imported when a device is first asked for."""


def door():
    """What _core asks devices through. Raises ImportError or RuntimeError with the reason if there is none."""
    try:
        from . import _cuda
    except ImportError as error:
        raise ImportError("clearance: this installation has no GPU part (it was built without nvcc, or it does not load: "
                          f"{error}); device=\"cpu\" works") from None
    if why := _cuda.no_device():
        raise RuntimeError(f"clearance: no CUDA device can be used: {why}; device=\"cpu\" works")
    return _cuda.door()
