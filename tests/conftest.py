"""For all tests: helpers' assertions are shown as those of tests are."""

import pytest

pytest.register_assert_rewrite("helpers")
