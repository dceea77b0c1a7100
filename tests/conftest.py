"""For all tests: what pytest is told, and how they share processors."""

import os

import pytest

pytest.register_assert_rewrite("helpers")

if "PYTEST_XDIST_WORKER" in os.environ:
    # each worker has a processor of its own: MKL's threads would wait for each other, at work
    for name in ("OMP_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ.setdefault(name, "1")


@pytest.hookimpl(optionalhook=True)  # where pytest-xdist is not installed
def pytest_xdist_auto_num_workers() -> int:
    """A worker for each processor that this process may use, up to 8: some tests take a gigabyte."""
    from febkit.solver.threads import available

    return min(available(), 8)
