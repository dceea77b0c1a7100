"""FEBio's command line: what of it means something here, and one line on what does not.

FEBio 4.11 takes ``-i -o -p -s -silent`` (``febkit run`` has them), names without ``.feb``, and the options below.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable

from febkit.record import value_record

from . import exits


@value_record
class Option:
    """``why`` febkit does not do it: empty where there is nothing to do; ``task``: it asks for another than solving.

    ``argument``: what follows is its own: "always", "perhaps" (what begins with no dash and is no .feb), or not ("").
    """

    why: str = ""
    task: bool = False
    argument: str = ""


_SETTINGS = Option("febkit reads no settings of FEBio's; --threads and --linear choose its own", argument="always")
_DUMP = "febkit run --checkpoint every=10min writes what --resume goes on from"
_DEBUG = Option("febkit saves the states that the file asks for, not those of every iteration")
OPTIONS = {
    "-nosplash": Option(),
    "-noconfig": Option(),
    "-noappend": Option(),
    "-no_title": Option(),
    "-config": _SETTINGS,
    "-cnf": _SETTINGS,
    "-import": Option("febkit loads no plugins; a feature that needs one is refused by its name", argument="always"),
    "-dump": Option(_DUMP, argument="perhaps"),
    "-dump_stride": Option(_DUMP),
    "-g": _DEBUG,
    "-g1": _DEBUG,
    "-g2": _DEBUG,
    "-break": Option("febkit has no prompt to stop at; Ctrl-C ends a run and keeps its states", argument="always"),
    "-no_log": Option("the log is written all the same; -o says where"),
    "-output_negative_jacobians": Option("febkit names the element that turned inside out and its part"),
    "-r": Option("febkit run MODEL.feb --resume goes on from its own checkpoint", task=True),
    "-d": Option("febkit has no diagnostic tests; febkit validate checks a model without solving it", task=True),
    "-norun": Option("febkit validate checks a model without solving it", task=True),
    "-info": Option("febkit --version says the version", task=True),
}
SOLVING = ("-i", "-o", "-p", "-s", "-silent", "-task")


def is_one(arg: str) -> bool:
    """Is an argument an option of FEBio's?"""
    name = arg.partition("=")[0]
    return name in OPTIONS or name in SOLVING


def understood(args: Iterable[str], say: Callable[[str], None]) -> list[str]:
    """``args`` of ``febkit run`` without those of FEBio's that change nothing here; ``say`` is told why.

    Raises Refused where one asks for another task than solving.
    """
    left = list(args)
    kept: list[str] = []
    while left:
        arg = left.pop(0)
        name, _, value = arg.partition("=")
        if arg == "--":
            return [*kept, arg, *left]
        if name == "-task":
            if value.strip('"') != "solve":
                raise exits.Refused(f"{arg}: febkit has one task, which is to solve")
            _skip("perhaps", left)
        elif name in OPTIONS:
            option = OPTIONS[name]
            if option.task:
                raise exits.Refused(f"{name} is an option of FEBio: {option.why}")
            if option.why:
                say(f"{name} is ignored: {option.why}")
            _skip(option.argument, left)
        else:
            kept.append(arg)
            if name in ("-i", "-o", "-p", "-s") and left:  # what follows is a name, whatever it looks like
                kept.append(left.pop(0))
    return kept


def _skip(argument: str, left: list[str]) -> None:
    """Take an option's own argument off what is left."""
    if argument and left and not left[0].startswith("-") and (argument == "always" or not _model(left[0])):
        left.pop(0)


def _model(name: str) -> bool:
    return name.lower().endswith(".feb")
