"""The viewer's page: controls around a picture that is drawn here and shown in the browser, by trame."""

from __future__ import annotations

import asyncio
from typing import Any

from .stage import Stage, of_names

FPS = 8.0
FOLLOW = 1.0  # seconds between looks at a file that may grow
_CLICK = 3  # pixels that a click may move before it is a turn of the body


class Page:
    """Controls, bound to a stage. All of it runs in the thread of the server's event loop."""

    def __init__(self, server: Any, stage: Stage) -> None:
        self.server, self.stage, self.state = server, stage, server.state
        self._pressed: tuple[int, int] | None = None
        self._tasks: list[Any] = []
        self._first_state()
        stage.draw()
        stage.look()
        self._layout()
        for names, change in (
            (("t",), self._time), (("variable", "component"), self._variable),
            (("scale", "cut", "at", "shown_parts", "edges", "fit"), self._settings), (("playing",), self._play),
        ):  # fmt: skip
            self.state.change(*names)(change)
        iren = stage.plotter.iren.interactor
        iren.AddObserver("LeftButtonPressEvent", self._press, 10.0)
        # while the body is turned its style keeps the release of the button to itself
        iren.AddObserver("EndInteractionEvent", self._release, 10.0)

    def _first_state(self) -> None:
        s, show = self.stage, self.stage.show
        name, _, word = show.variable.partition(":")
        choices = s.components(name)
        self.state.update({
            "trame__title": f"{s.name} - febkit", "last": max(len(s.times()) - 1, 0), "t": max(s.t, 0),
            "clock": s.clock,
            "variables": of_names(s.variables()), "variable": name, "components": choices,
            "component": word or s.quantity.word, "scale": show.scale, "cut": show.cut or "none", "at": show.at,
            "all_parts": s.parts(), "shown_parts": s.parts(), "edges": show.edges, "fit": show.fit, "playing": False,
            "picked": "", "said": "", "drawn": 0,
        })  # fmt: skip

    def _layout(self) -> None:
        from trame.ui.vuetify3 import SinglePageWithDrawerLayout
        from trame.widgets import client, html, vtk
        from trame.widgets import vuetify3 as v

        with SinglePageWithDrawerLayout(self.server, full_height=True) as layout:
            client.Style("html {overflow-y: hidden !important}")
            layout.title.set_text(self.stage.name)
            layout.footer.hide()
            with layout.toolbar as bar:
                bar.density = "compact"
                v.VBtn(icon=("playing ? 'mdi-pause' : 'mdi-play'",), click="playing = !playing", id="play")
                v.VSlider(v_model=("t",), min=0, max=("last",), step=1, hide_details=True, density="compact", id="time",
                          style="max-width: 45%", classes="mx-4")  # fmt: skip
                html.Span("{{ clock }}", id="clock", style="min-width: 8em")
                v.VSpacer()
                html.Span("{{ picked }}", id="picked", classes="mr-4 text-body-2")
            with layout.drawer as drawer:
                drawer.width = 260
                self._controls(v, html)
            with layout.content, v.VContainer(fluid=True, classes="pa-0 fill-height"):
                html.Div("{{ said }}", v_if="said", id="said", classes="pa-2 text-error",
                         style="position: absolute; z-index: 2")  # fmt: skip
                self.picture = vtk.VtkRemoteView(
                    self.stage.plotter.render_window, interactive_ratio=1, still_quality=95, id="picture"
                )
            html.Span("{{ drawn }}", id="drawn", style="display: none")
            html.Span("{{ last }}", id="last", style="display: none")

    def _controls(self, v: Any, html: Any) -> None:
        tight = {"density": "compact", "hide_details": True}
        with v.VContainer(classes="pa-3"):
            v.VSelect(v_model=("variable",), items=("variables",), label="Variable", id="variable", **tight)
            v.VSelect(v_model=("component",), items=("components",), label="Component", v_if="components.length",
                      classes="mt-3", id="component", **tight)  # fmt: skip
            html.Div("Deformed {{ Number(scale).toFixed(1) }} times", classes="mt-4 text-body-2")
            v.VSlider(v_model=("scale",), min=0, max=20, step=0.5, id="scale", **tight)
            html.Div("Cut open across", classes="mt-4 text-body-2")
            with v.VBtnToggle(v_model=("cut",), mandatory=True, density="compact", divided=True, border=True):
                for name in ("none", "x", "y", "z"):
                    v.VBtn("whole" if name == "none" else name, value=name, size="small", id=f"cut-{name}")
            v.VSlider(v_model=("at",), min=0, max=1, step=0.01, disabled=("cut === 'none'",), id="at", **tight)
            v.VSwitch(v_model=("edges",), label="Edges of elements", color="primary", **tight)
            v.VSwitch(v_model=("fit",), label="Colours of this state alone", color="primary", **tight)
            html.Div("Parts", classes="mt-2 text-body-2")
            v.VCheckbox(v_for="name in all_parts", key="name", v_model=("shown_parts",), label=("name",),
                        value=("name",), **tight)  # fmt: skip
            with v.VBtn(click=self._reset, size="small", classes="mt-3", id="reset"):
                html.Span("Reset view")

    def refresh(self) -> None:
        """Draw, and push the picture to the browser."""
        s, state = self.stage, self.state
        with state:
            state.said = s.draw()
            state.clock = s.clock
            state.drawn += 1
        self.picture.update()

    def _time(self, t: float, **_: Any) -> None:
        if int(t) != self.stage.t:
            self.stage.set(t=int(t))
            self.refresh()

    def _variable(self, variable: str, component: str, **_: Any) -> None:
        choices = self.stage.components(variable)
        if component not in choices:
            component = next((c for c in ("effective", "magnitude", *choices) if c in choices), "")
        self.state.components, self.state.component = choices, component
        text = f"{variable}:{component}" if component else variable
        if text != self.stage.show.variable:
            self.stage.set(variable=text)
            self.refresh()

    def _settings(
        self, scale: float, cut: str, at: float, shown_parts: list[str], edges: bool, fit: bool, **_: Any
    ) -> None:
        parts = None if set(shown_parts) >= set(self.stage.parts()) else tuple(shown_parts)
        cut = "" if cut == "none" else cut
        new = dict(scale=float(scale), cut=cut, at=float(at), parts=parts, edges=edges, fit=fit)
        if any(getattr(self.stage.show, k) != value for k, value in new.items()):
            self.stage.set(**new)
            self.refresh()

    def _reset(self) -> None:
        self.stage.look()
        self.refresh()

    def _play(self, playing: bool, **_: Any) -> None:
        if playing:
            self._tasks.append(asyncio.get_event_loop().create_task(self._run()))

    async def _run(self) -> None:
        while self.state.playing:
            n = len(self.stage.times())
            with self.state:
                self.state.t = (int(self.state.t) + 1) % max(n, 1)
            self._time(self.state.t)
            await asyncio.sleep(1 / FPS)

    async def follow(self) -> None:
        """Look at the file now and then for ever."""
        while True:
            await asyncio.sleep(FOLLOW)
            if self.stage.grew():
                with self.state:
                    self.state.last = max(len(self.stage.times()) - 1, 0)
                    self.state.t = max(self.stage.t, 0)
                self.refresh()

    def _press(self, caller: Any, _: str) -> None:
        self._pressed = caller.GetEventPosition()

    def _release(self, caller: Any, _: str) -> None:
        at, before = caller.GetEventPosition(), self._pressed
        self._pressed = None
        if before is None or max(abs(at[0] - before[0]), abs(at[1] - before[1])) > _CLICK:
            return
        found = self.stage.pick(*at)
        with self.state:
            self.state.picked = found["text"] if found else ""
