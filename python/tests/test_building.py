# SPDX-License-Identifier: BSD-3-Clause
"""The build backend: the GPU part is built only if it is asked for, and its compiler comes from PyPI only if there is none."""

import importlib.util
import os
import pathlib
import re
import subprocess
import sys

import pytest

root = pathlib.Path(__file__).resolve().parents[2]
pytest.importorskip("scikit_build_core", reason="needs scikit-build-core")
if not (root / "python" / "build_backend.py").exists():
    pytest.skip("needs a checkout", allow_module_level=True)

ASKED = [{"cmake.define.CLEARANCE_CUDA": "ON"}, {"cmake.define.CLEARANCE_CUDA": ["OFF", "1"]}]
HOOKS = ["get_requires_for_build_wheel", "get_requires_for_build_editable"]


@pytest.fixture
def backend(monkeypatch, tmp_path):
    """The backend on a machine without nvcc, asked for nothing."""
    for name in ("CLEARANCE_CUDA", "CUDACXX", "CMAKE_CUDA_COMPILER"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("CUDA_PATH", str(tmp_path / "none"))
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.chdir(root)
    spec = importlib.util.spec_from_file_location("build_backend", root / "python" / "build_backend.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def of_cuda(requirements):
    return [r for r in requirements if re.search("cuda|nvidia", r)]


def executable(file):
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text("#!/bin/sh\n")
    file.chmod(0o755)
    return file


@pytest.mark.parametrize("hook", HOOKS)
def test_by_default_nothing_of_cuda_is_required(backend, hook):
    assert of_cuda(getattr(backend, hook)()) == []
    assert of_cuda(getattr(backend, hook)({"cmake.define.CLEARANCE_CUDA": "OFF"})) == []


@pytest.mark.parametrize("hook", HOOKS)
@pytest.mark.parametrize("settings", [None, *ASKED])
def test_without_nvcc_it_comes_from_pypi(backend, hook, settings, monkeypatch):
    if settings is None:
        monkeypatch.setenv("CLEARANCE_CUDA", "1")
    assert of_cuda(getattr(backend, hook)(settings)) == ["cuda-toolkit[nvcc,cudart,cccl]>=13"]


@pytest.mark.parametrize("where", ["PATH", "CUDACXX", "CUDA_PATH"])
def test_an_nvcc_that_is_installed_is_taken(backend, where, monkeypatch, tmp_path):
    nvcc = executable(tmp_path / "toolkit" / "bin" / "nvcc")
    value = {"PATH": nvcc.parent, "CUDACXX": nvcc, "CUDA_PATH": nvcc.parents[1]}[where]
    monkeypatch.setenv(where, str(value))
    assert of_cuda(backend.get_requires_for_build_wheel(ASKED[0])) == []
    backend.with_nvcc(ASKED[0])
    assert os.environ["CUDACXX"] == str(nvcc)


def test_the_compiler_from_pypi_is_found_and_completed(backend, monkeypatch, tmp_path):
    nvcc = executable(tmp_path / "site" / "nvidia" / "cu13" / "bin" / "nvcc")
    library = executable(nvcc.parents[1] / "lib" / "libcudart.so.13")
    monkeypatch.syspath_prepend(str(tmp_path / "site"))
    monkeypatch.setenv("CUDACXX", "for monkeypatch to restore")
    monkeypatch.delenv("CUDACXX")
    for _ in range(2):  # complete already
        monkeypatch.delenv("CUDACXX", raising=False)
        backend.with_nvcc(ASKED[0])
        assert os.environ["CUDACXX"] == str(nvcc)
        assert (nvcc.parents[1] / "lib64" / "libcudart.so").resolve() == library


def test_no_compiler_at_all_is_a_sentence(backend):
    with pytest.raises(RuntimeError, match="no nvcc: set CUDACXX"):
        backend.with_nvcc(ASKED[0])
    backend.with_nvcc(None)  # nobody asked


def test_a_word_that_is_no_answer_is_refused(backend, monkeypatch):
    monkeypatch.setenv("CLEARANCE_CUDA", "cuda:0")
    with pytest.raises(ValueError, match="CLEARANCE_CUDA is 'cuda:0'"):
        backend.get_requires_for_build_wheel()


@pytest.mark.parametrize("settings, environment, expected", [
    ({}, {}, ("OFF", "")),
    ({}, {"CLEARANCE_CUDA": "1", "CLEARANCE_CUDA_ARCHITECTURES": "87-real;110-real"}, ("1", "87-real;110-real")),
    ({"cmake.define.CLEARANCE_CUDA": "ON"}, {}, ("ON", "")),
    ({"cmake.define.CLEARANCE_CUDA": "OFF"}, {"CLEARANCE_CUDA": "1"}, ("OFF", "")),
])
def test_cmake_is_told_what_was_asked(settings, environment, expected, monkeypatch):
    from scikit_build_core.settings.skbuild_read_settings import SettingsReader

    for name in ("CLEARANCE_CUDA", "CLEARANCE_CUDA_ARCHITECTURES"):
        monkeypatch.delenv(name, raising=False)
    for name, value in environment.items():
        monkeypatch.setenv(name, value)
    told = SettingsReader.from_file(root / "pyproject.toml", settings).settings.cmake.define
    assert (told["CLEARANCE_CUDA"], told["CLEARANCE_CUDA_ARCHITECTURES"]) == expected


def test_there_is_one_list_of_wheels():
    said = subprocess.run([sys.executable, root / "scripts" / "cuda_wheels.py"], capture_output=True, text=True, check=True)
    assert said.stdout == "cuda-toolkit[nvcc,cudart,cccl]\n"
    others = [f for f in (root / "scripts" / "cuda-from-pypi", root / "pyproject.toml", root / "python" / "build_backend.py")
              if "toolkit[" in f.read_text()]
    assert others == []
