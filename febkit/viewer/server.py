"""The viewer's server: a thread with an event loop of its own, so that programs and notebooks go on."""

from __future__ import annotations

import asyncio
import threading
from itertools import count
from typing import Any

from febkit.model import InputError

from .stage import Stage

_numbers = count(1)
_PATIENCE = 60.0  # seconds to start in


class View:
    """A viewer that is open: ``url`` of its page; :meth:`stop` ends it."""

    def __init__(self, stage: Stage, port: int = 0, height: int = 640) -> None:
        try:
            import trame.app
            import trame.ui.vuetify3
            import trame.widgets.vtk  # noqa: F401
        except ImportError as e:
            raise InputError(f'the viewer needs trame ({e}): pip install "febkit[viewer]"') from None
        self.stage, self.height = stage, height
        self._ready = threading.Event()
        self._failure: BaseException | None = None
        self._loop: asyncio.AbstractEventLoop | None = None
        self._server: Any = None
        self.page: Any = None
        self._thread = threading.Thread(target=self._serve, args=(port,), name="febkit viewer", daemon=True)
        self._thread.start()
        if not self._ready.wait(_PATIENCE):
            raise InputError(f"the viewer did not start within {_PATIENCE:g} s")
        if self._failure is not None:
            raise InputError(f"the viewer did not start: {self._failure}") from self._failure

    def _serve(self, port: int) -> None:
        from trame.app import get_server

        from .page import Page

        self._loop = asyncio.new_event_loop()
        asyncio.set_event_loop(self._loop)
        try:
            self._server = get_server(f"febkit-{next(_numbers)}", client_type="vue3")
            self.page = Page(self._server, self.stage)
            self._server.controller.on_server_ready.add(lambda **_: self._ready.set())
            self._loop.create_task(self._start(port))
            following = self._loop.create_task(self.page.follow())
            self._loop.run_forever()
            following.cancel()
            self._loop.run_until_complete(asyncio.gather(following, return_exceptions=True))
        except BaseException as e:
            self._failure = e
            self._ready.set()
        finally:
            self.stage.close()

    async def _start(self, port: int) -> None:
        try:
            await self._server.start(
                port=port, host="127.0.0.1", thread=True, open_browser=False, show_connection_info=False,
                disable_logging=True, exec_mode="coroutine", timeout=0,
            )  # fmt: skip
        except BaseException as e:
            self._failure = e
            self._ready.set()
            asyncio.get_event_loop().stop()

    @property
    def url(self) -> str:
        return f"http://127.0.0.1:{self._server.port}/index.html"

    @property
    def running(self) -> bool:
        return self._thread.is_alive()

    def stop(self) -> None:
        """Close the page's server and the file."""
        loop = self._loop
        if loop is None or not self.running:
            return
        asyncio.run_coroutine_threadsafe(self._server.stop(), loop)
        loop.call_soon_threadsafe(lambda: loop.call_later(0.2, loop.stop))
        self._thread.join(10)

    def wait(self) -> None:
        """Until the viewer is stopped, or Ctrl-C."""
        while self.running:
            self._thread.join(0.5)

    def __repr__(self) -> str:
        return f"viewer of {self.stage.name} at {self.url}" if self.running else f"viewer of {self.stage.name}, stopped"

    def _repr_html_(self) -> str:
        return f'<iframe src="{self.url}" style="width: 100%; height: {self.height}px; border: 0"></iframe>'
