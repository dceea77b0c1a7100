"""For all tests: what pytest is told, and how they share processors."""

import os
import signal
import threading

import pytest

pytest.register_assert_rewrite("helpers")

# as where febkit was installed by pip: processes do not compile its sources each time
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)

if "PYTEST_XDIST_WORKER" in os.environ:
    # each worker has a processor of its own: MKL's threads would wait for each other, at work
    for name in ("OMP_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ.setdefault(name, "1")

if threading.current_thread() is threading.main_thread():
    # tests started in the background of a shell or by nohup: what these have processes ignore, the commands under test
    # would ignore too; a handler, unlike an ignored signal, does not pass to them
    for number in (signal.SIGINT, getattr(signal, "SIGHUP", signal.SIGINT)):
        if signal.getsignal(number) == signal.SIG_IGN:
            signal.signal(number, lambda *_: None)


@pytest.hookimpl(optionalhook=True)  # where pytest-xdist is not installed
def pytest_xdist_auto_num_workers() -> int:
    """A worker for each processor that this process may use, up to 8: some tests take a gigabyte."""
    from febkit.solver.threads import available

    return min(available(), 8)


# files of few tests that take long; begun last, they would keep one worker busy while the others have nothing left
LONG = (
    "test_blocks", "test_compiling", "test_build", "test_study", "test_sweep", "test_notebooks", "test_resume",
    "test_wheel",
)  # fmt: skip


def pytest_configure(config: pytest.Config) -> None:
    if hasattr(config.option, "loadscopereorder"):
        config.option.loadscopereorder = False  # files in the order below, not those of many tests first


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    items.sort(key=lambda i: LONG.index(i.path.stem) if i.path.stem in LONG else len(LONG))
