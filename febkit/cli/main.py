"""``febkit``: one verb, one file; a verb is imported when it is asked for."""

from __future__ import annotations

import sys
from importlib import import_module

import click

from febkit._version import __version__

from . import exits, printing, signals

VERBS = {
    "info": "Say what is in a model or a results file.",
    "validate": "Check an input offline.",
    "features": "List FEBio's types and what febkit does with each.",
    "convert": "Convert between .feb versions, results and mesh formats.",
    "run": "Solve a .feb model.",
    "new": "Write a model from a template.",
    "boundary": "Write the boundary of a cell model from a tissue result.",
    "metrics": "Measure cells in a results file.",
    "compare": "Compare cell metrics of two models statistically.",
    "plot": "Draw figures of metrics and results.",
    "view": "Look at results in the browser.",
    "fit": "Fit parameters of models to experiments.",
    "sweep": "Solve a model at many values of its parameters.",
    "study": "Plan, run and report a whole study.",
    "diff": "Compare two inputs or two results.",
}


class Verbs(click.Group):
    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(VERBS)

    def get_command(self, ctx: click.Context, name: str) -> click.Command | None:
        if name not in VERBS:
            return None
        command = import_module(f"febkit.cli.{name}").command
        assert isinstance(command, click.Command)
        return command

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        with formatter.section("Verbs"):
            formatter.write_dl(list(VERBS.items()))


@click.group(cls=Verbs, context_settings={"help_option_names": ["-h", "--help"]},
             epilog="febkit help VERB says more of one; febkit MODEL.feb solves a model, with FEBio's options.")
@click.version_option(__version__, prog_name="febkit")
def cli() -> None:
    """Read, write, convert and solve FEBio models; hand tissue results to cell models; measure cells."""


def main() -> None:
    """Run the command line. Whatever happens is a sentence and an exit code (:mod:`.exits`), never a traceback."""
    printing.prepare()
    signals.watch()
    try:
        code = _call(sys.argv[1:])
    except KeyboardInterrupt:  # a second one, while the first was dealt with
        code = signals.exit_code()
    sys.exit(code)


def command() -> None:
    """The entry point of the installed command: as :func:`main`, in a process that ends with it."""
    from febkit import process

    try:
        main()
    except SystemExit as e:
        if not isinstance(e.code, int):
            raise
        process.leave(e.code)


def _call(args: list[str]) -> int:
    try:
        code = cli.main(_verb_first(args), prog_name="febkit", standalone_mode=False)
        sys.stdout.flush()
        return code if isinstance(code, int) else exits.DONE  # click hands back what its Exit was raised with
    except click.exceptions.NoArgsIsHelpError as e:
        printing.note(e.format_message())
        return exits.BAD_INPUT
    except click.UsageError as e:
        verb = e.ctx.command_path if e.ctx is not None else "febkit"
        printing.fail(f"{e.format_message()} ({verb} --help says more)")
        return exits.BAD_INPUT
    except click.ClickException as e:
        printing.fail(e.format_message())
        return exits.BAD_INPUT
    except (click.Abort, KeyboardInterrupt):
        return _interrupted()
    except OSError as e:
        printing.fail(_of_the_system(e))
        return exits.BAD_INPUT
    except UnicodeEncodeError as e:
        if not any("\udc80" <= c <= "\udcff" for c in str(e.object)):
            return _unforeseen(e, args)
        printing.fail(f"the name {e.object} is not UTF-8, which this kind of file needs: rename what is called so")
        return exits.BAD_INPUT
    except MemoryError as e:
        printing.fail(f"there is not enough memory{f': {e}' if str(e) else ''}")
        return exits.BAD_INPUT
    except Exception as e:
        source = sys.modules.get("febkit.model.source")  # who raises its error has imported it; help has not
        if source is not None and isinstance(e, source.InputError):
            printing.fail(e)
            return exits.BAD_INPUT
        return _unforeseen(e, args)


def _unforeseen(e: Exception, args: list[str]) -> int:
    from . import crash

    return crash.report(e, args)


def _interrupted() -> int:
    printing.note("interrupted")
    return signals.exit_code()


def _of_the_system(e: OSError) -> str:
    """The file's name and what the system says of it."""
    name = e.filename.decode(errors="backslashreplace") if isinstance(e.filename, bytes) else e.filename
    said = e.strerror or str(e) or type(e).__name__
    return f"{name}: {said}" if isinstance(name, str) and name else said


def _verb_first(args: list[str]) -> list[str]:
    """``help [VERB]`` as ``[VERB] --help``; FEBio's ``MODEL.feb`` and ``-i MODEL.feb`` as ``run ...``."""
    if not args or args[0] in VERBS:
        return args
    first, *rest = args
    if first == "help":
        return [*rest, "--help"]
    if first.lower().endswith(".feb") or any(map(_of_febio, args)):
        return ["run", *args]
    if first.startswith("-"):
        return args
    from difflib import get_close_matches
    from pathlib import Path

    if Path(first).is_file() or Path(f"{first}.feb").is_file():
        return ["run", *args]
    near = get_close_matches(first, [*VERBS, "help"], 1)
    raise click.UsageError(f"{first} is no verb and no model" + (f"; did you mean {near[0]}?" if near else ""))


def _of_febio(arg: str) -> bool:
    if not arg.startswith("-"):
        return False
    from .febio_options import is_one

    return is_one(arg)


if __name__ == "__main__":
    command()
