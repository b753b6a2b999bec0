# SPDX-License-Identifier: BSD-3-Clause
"""The way to the GPU part, which is imported when a device is first asked for."""


def door():
    """What _core asks devices through. Raises ImportError or RuntimeError with the reason if there is none."""
    try:
        from . import _cuda
    except ImportError as error:
        missing = isinstance(error, ModuleNotFoundError) or "cannot import name" in str(error)
        why = "is not in this installation; CLEARANCE_CUDA=1 pip install . builds it" if missing else f"does not load: {error}"
        raise ImportError(f"clearance: the GPU part {why}; device=\"cpu\" works") from None
    if why := _cuda.no_device():
        raise RuntimeError(f"clearance: no CUDA device can be used: {why}; device=\"cpu\" works")
    return _cuda.door()
