"""What becomes of files, verb by verb: the table of docs/outputs.md and of tests/cli/test_outputs.py.

``python tests/helpers/outputs.py --write`` renews the page.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass, field
from pathlib import Path

PAGE = Path(__file__).parents[2] / "docs" / "outputs.md"
START, END = "<!-- table: start -->", "<!-- table: end -->"

SITUATIONS = (
    "good input", "bad input", "missing file", "output onto input", "existing output", "read-only folder", "full disk",
    "killed in mid-run", "Ctrl-C", "two at once",
)  # fmt: skip


@dataclass(frozen=True)
class Verb:
    """How a verb is called in the test's folder, and what it does to files. ``kind``: "reads" (writes nothing),
    "makes" (a model or a copy: --force), "derives" (a table, a picture, a report: replaced) or "runs"."""

    kind: str
    good: str  # arguments; OUT stands for the output
    bad: str
    missing: str
    onto: str = ""  # arguments that send the output onto an input
    out: str = ""
    reads: str = ""  # the file whose reading is interrupted, of a verb that writes nothing
    also: dict[str, str] = field(default_factory=dict)  # situation -> what the page adds


VERBS = {
    "info": Verb("reads", "m.xplt", "junk.xplt", "none.xplt", reads="m.xplt"),
    "validate": Verb("reads", "m.feb", "bad.feb", "none.feb", reads="m.feb"),
    "diff": Verb("reads", "m.xplt m.xplt", "m.xplt junk.xplt", "m.xplt none.xplt", reads="m.xplt"),
    "convert": Verb("makes", "m.feb OUT", "junk.feb OUT", "none.feb OUT", "m.feb m.feb", "new.feb"),
    "new": Verb("makes", "tissue --set n=3 -o OUT", "tissue --set n=x -o OUT", "tissue --params none.toml -o OUT",
                "tissue --params p.feb -o p.feb", "new.feb"),
    "boundary": Verb("makes", "f.csv m.feb -o OUT", "junk.csv m.feb -o OUT", "none.csv m.feb -o OUT",
                     "f.csv m.feb -o m.feb", "new.feb"),
    "metrics": Verb("derives", "m.nc -m m.feb -c part -o OUT", "junk.xplt -o OUT", "none.nc -o OUT", "m.nc -o m.nc",
                    "new.nc"),
    "compare": Verb("derives", "a.nc b.nc --instantaneous 1 -o OUT", "a.nc junk.nc -o OUT", "a.nc none.nc -o OUT",
                    "a.nc b.nc -o b.nc", "new.nc"),
    "plot": Verb("derives", "histories a.nc -o OUT", "histories junk.nc -o OUT", "histories none.nc -o OUT",
                 "histories a.nc -o linked.png", "new.png"),
    "study": Verb("derives", "report s.toml --no-figures -o report", "report bad.toml -o report",
                  "report none.toml -o report", "", "report/metrics.nc", "",
                  {"killed in mid-run": "finished steps are kept", "two at once": "of `study run`: 2, one at a time"}),
    "fit": Verb("makes", "fit.toml -w OUT", "bad.toml -w OUT", "none.toml -w OUT", "fit.toml -w few.feb", "new.feb"),
    "sweep": Verb("derives", "few.feb --vary m.E=1:2 --observe 'reaction top z' --samples 2 "
                  "--scheduler serial -o OUT", "few.feb --vary m.E=soft --observe 'reaction top z' -o OUT",
                  "none.feb --vary E=1:2 --observe 'reaction top z' -o OUT", "", "new.nc", "",
                  {"killed in mid-run": "finished samples are kept",
                   "two at once": "while samples are left: 2, one at a time"}),
    "run": Verb("runs", "m.feb -p OUT -o m.log", "bad.feb -p OUT -o m.log", "none.feb -p OUT -o m.log",
                "m.feb -p linked.xplt -o m.log", "new.xplt"),
}  # fmt: skip

# what a cell says; the tests of the same name hold the verbs to it
OUTCOMES = {
    "reads": dict.fromkeys(SITUATIONS, "-") | {
        "good input": "0", "bad input": "2", "missing file": "2, named", "killed in mid-run": "nothing is written",
        "Ctrl-C": "130",
    },
    "makes": {
        "good input": "0, written", "bad input": "2, nothing written", "missing file": "2, named",
        "output onto input": "2, input unchanged", "existing output": "2, unchanged; `--force` replaces it",
        "read-only folder": "2, folder named", "full disk": "2, file named; earlier one stays",
        "killed in mid-run": "earlier one stays", "Ctrl-C": "130, earlier one stays",
        "two at once": "the later one: 2, exists already",
    },
    "derives": {
        "good input": "0, written", "bad input": "2, nothing written", "missing file": "2, named",
        "output onto input": "2, input unchanged", "existing output": "replaced",
        "read-only folder": "2, folder named", "full disk": "2, file named; earlier one stays",
        "killed in mid-run": "earlier one stays", "Ctrl-C": "130, earlier one stays",
        "two at once": "each whole; the later one stays",
    },
    "runs": {
        "good input": "0, written", "bad input": "2, nothing written", "missing file": "2, named",
        "output onto input": "2, input unchanged", "existing output": "an earlier result is replaced; another file: 2",
        "read-only folder": "2, folder named", "full disk": "2, file named; complete states stay",
        "killed in mid-run": "every announced state stays; before the first, the earlier result",
        "Ctrl-C": "130, as killed; the log says so", "two at once": "the later one: 2, process named",
    },
}  # fmt: skip


def outcome(verb: str, situation: str) -> str:
    """What a cell says."""
    v = VERBS[verb]
    said = OUTCOMES[v.kind][situation]
    if situation == "output onto input" and not v.onto:
        said = "-"
    return "; ".join(x for x in (said, v.also.get(situation)) if x and x != "-") or "-"


def cells() -> list[tuple[str, str]]:
    """(verb, situation) of each cell that says something."""
    return [(v, s) for v in VERBS for s in SITUATIONS if outcome(v, s) != "-"]


def table() -> str:
    """The table in Markdown, a row for each situation."""
    rows = [["", *(f"`{v}`" for v in VERBS)], ["---"] * (len(VERBS) + 1)]
    rows += [[s, *(outcome(v, s) for v in VERBS)] for s in SITUATIONS]
    return "\n".join(f"| {' | '.join(r)} |" for r in rows)


def renewed(text: str) -> str:
    """The page with the table as it should be."""
    head, rest = text.split(START)
    _, tail = rest.split(END)
    return f"{head}{START}\n{table()}\n{END}{tail}"


if __name__ == "__main__":
    if "--write" in sys.argv:
        PAGE.write_text(renewed(PAGE.read_text()))
    else:
        print(table())
