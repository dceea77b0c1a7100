"""Finds the packages, solver/ and templates/ by the names that pyproject.toml gives them; builds machine code.

A C compiler is needed for it and numba; where there is none the package works all the same, and compiles what a model
needs when it is first solved. FEBKIT_LEVELS says for which processors (docs/machine_code.md).
"""

import ctypes
import hashlib
import os
import subprocess
import sys
import tomllib
from pathlib import Path

import numpy
from setuptools import Extension, find_packages, setup
from setuptools.command.build_ext import build_ext


class Build(build_ext):
    """Builds the extension and the libraries of kernels beside it."""

    def run(self):
        super().run()
        asked = os.environ.get("FEBKIT_LEVELS", "none" if self.editable_mode else "").split()
        if asked != ["none"] and self.get_outputs() and Path(self.get_outputs()[0]).exists():
            try:
                self.libraries_of_kernels(asked or ["native"])
            except Exception as e:
                if asked:
                    raise
                print(f"no machine code in this build ({e}): kernels will be compiled when they are first used")

    def libraries_of_kernels(self, levels):
        built = Path.cwd() if self.editable_mode else Path(self.build_lib).resolve()
        objects = Path(self.build_temp).resolve() / "machine"
        paths = [str(built), os.environ.get("PYTHONPATH")]  # pip's build environment is found by the second
        env = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, paths))}
        subprocess.run([sys.executable, "-m", "febkit.solver.build", objects, *levels], env=env, check=True)
        for folder in objects.iterdir():
            made = sorted(folder.glob("*.o"))
            kind = {"win32": ".dll", "darwin": ".dylib"}.get(sys.platform, ".so")
            library = built / "febkit" / "solver" / "machine" / f"{folder.name}{kind}"
            self.compiler.link_shared_object(
                [str(p) for p in made], str(library), export_symbols=[p.stem for p in made],
                libraries=["msvcrt", "ucrt", "vcruntime"] if sys.platform == "win32" else ["m"],
            )  # fmt: skip
            ctypes.CDLL(str(library))  # raises OSError where a symbol is nowhere
            library.with_suffix(".sha256").write_text(hashlib.sha256(library.read_bytes()).hexdigest())


with open("pyproject.toml", "rb") as f:
    placed = tomllib.load(f)["tool"]["setuptools"]["package-dir"]

# the links of febkit/ to the placed folders are for static readers, and no packages
packages = find_packages(include=["febkit", "febkit.*"], exclude=[n + end for n in placed for end in ("", ".*")])
for name, folder in placed.items():
    packages += [name, *(f"{name}.{p}" for p in find_packages(folder))]
call = Extension("febkit.solver._call", ["solver/_call.c"], include_dirs=[numpy.get_include()], optional=True)
setup(packages=packages, ext_modules=[call], cmdclass={"build_ext": Build})
