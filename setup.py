"""Finds the packages, solver/ and templates/ by the names that pyproject.toml gives them; all else is said there."""

import tomllib

import numpy
from setuptools import Extension, find_packages, setup

with open("pyproject.toml", "rb") as f:
    placed = tomllib.load(f)["tool"]["setuptools"]["package-dir"]

# the links of febkit/ to the placed folders are for static readers, and no packages
packages = find_packages(include=["febkit", "febkit.*"], exclude=[n + end for n in placed for end in ("", ".*")])
for name, folder in placed.items():
    packages += [name, *(f"{name}.{p}" for p in find_packages(folder))]
# what calls machine code; without a C compiler kernels are called by ctypes
call = Extension("febkit.solver._call", ["solver/_call.c"], include_dirs=[numpy.get_include()], optional=True)
setup(packages=packages, ext_modules=[call])
