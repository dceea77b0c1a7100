"""A real browser without a window."""

from __future__ import annotations

import shutil
from typing import Any

import pytest


def chromium(width: int = 1200, height: int = 850) -> Any:
    """A selenium driver of chromium; to be quit. Skips the test where there is none."""
    webdriver = pytest.importorskip("selenium.webdriver", reason="browsers are driven by selenium")
    from selenium.webdriver.chrome.service import Service

    chrome = next((p for n in ("chromium", "chromium-browser", "google-chrome") if (p := shutil.which(n))), None)
    driver = shutil.which("chromedriver")
    if chrome is None or driver is None:
        pytest.skip("there is no chromium and chromedriver on this machine")
    options = webdriver.ChromeOptions()
    options.binary_location = chrome
    window = f"--window-size={width},{height}"
    for a in ("--headless=new", "--no-sandbox", window, "--disable-gpu", "--disable-dev-shm-usage"):
        options.add_argument(a)
    return webdriver.Chrome(options=options, service=Service(driver))
