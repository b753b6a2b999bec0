# SPDX-License-Identifier: BSD-3-Clause
"""scikit-build-core, which also brings NVIDIA's compiler from PyPI where the GPU part is asked for and no nvcc is installed.

CLEARANCE_CUDA=1 pip install .     asks for it; so does pip install . -Ccmake.define.CLEARANCE_CUDA=ON
"""

import os
import pathlib
import shutil
import sys

from scikit_build_core import build as inner
from scikit_build_core.build import *  # noqa: F403

root = pathlib.Path(__file__).resolve().parents[1]


def cuda_wanted(config_settings):
    """Whether the GPU part is asked for. Raises ValueError for a word that is neither yes nor no."""
    said = (config_settings or {}).get("cmake.define.CLEARANCE_CUDA", os.environ.get("CLEARANCE_CUDA", ""))
    word = str(said[-1] if isinstance(said, list) and said else said).strip().lower()
    if word in ("1", "on", "yes", "true"):
        return True
    if word in ("", "0", "off", "no", "false"):
        return False
    raise ValueError(f"CLEARANCE_CUDA is {said!r}; it is 1 (with the GPU part) or 0 (without)")


def installed_nvcc():
    """The nvcc that CMake would find, or None."""
    for named in ("CUDACXX", "CMAKE_CUDA_COMPILER"):
        if os.environ.get(named):
            return os.environ[named]
    usual = pathlib.Path(os.environ.get("CUDA_PATH") or "/usr/local/cuda") / "bin" / "nvcc"
    return shutil.which("nvcc") or (str(usual) if usual.is_file() else None)


def cuda_wheels():
    """scripts/cuda_wheels.py, where it stands what CUDA's compiler takes."""
    import importlib.util

    spec = importlib.util.spec_from_file_location("cuda_wheels", root / "scripts" / "cuda_wheels.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def more_requirements(config_settings):
    """What has to be installed for the GPU part."""
    if not cuda_wanted(config_settings) or installed_nvcc():
        return []
    wheels = cuda_wheels()
    return [wheels.requirement + wheels.version]


def with_nvcc(config_settings):
    """Tells CMake where nvcc is, if it came from PyPI. Raises RuntimeError if there is none."""
    if not cuda_wanted(config_settings) or "CUDACXX" in os.environ:
        return
    nvcc = installed_nvcc()
    if nvcc is None:
        here = (pathlib.Path(folder or ".") for folder in sys.path)
        found = sorted(file for folder in here for file in folder.glob("nvidia/cu*/bin/nvcc"))
        if not found:
            raise RuntimeError("CLEARANCE_CUDA is on, and there is no nvcc: set CUDACXX to it, or build with isolation")
        nvcc = str(found[-1])
        cuda_wheels().complete(found[-1].parents[1])
    os.environ["CUDACXX"] = nvcc


def get_requires_for_build_wheel(config_settings=None):
    return inner.get_requires_for_build_wheel(config_settings) + more_requirements(config_settings)


def get_requires_for_build_editable(config_settings=None):
    return inner.get_requires_for_build_editable(config_settings) + more_requirements(config_settings)


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    with_nvcc(config_settings)
    return inner.build_wheel(wheel_directory, config_settings, metadata_directory)


def build_editable(wheel_directory, config_settings=None, metadata_directory=None):
    with_nvcc(config_settings)
    return inner.build_editable(wheel_directory, config_settings, metadata_directory)
