"""``febkit``: one verb, one file; a verb is imported when it is asked for."""

from __future__ import annotations

from importlib import import_module

import click

from febkit._version import __version__

VERBS = {
    "info": "Say what is in a model or a results file.",
    "validate": "Check an input offline.",
    "convert": "Convert between .feb versions, results and mesh formats.",
    "run": "Solve a .feb model.",
    "new": "Write a model from a template.",
    "boundary": "Write the boundary of a cell model from a tissue result.",
    "metrics": "Measure cells in a results file.",
    "compare": "Compare cell metrics of two models statistically.",
    "plot": "Draw figures of metrics and results.",
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


@click.group(cls=Verbs, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, prog_name="febkit")
def cli() -> None:
    """Read, write, convert and solve FEBio models; hand tissue results to cell models; measure cells."""


def main() -> None:
    """Run the command line; bad input is a message and exit code 2, never a traceback."""
    import sys

    try:
        cli.main(standalone_mode=False)
    except click.ClickException as e:
        e.show()
        sys.exit(2)
    except click.exceptions.Exit as e:
        sys.exit(e.exit_code)
    except (click.Abort, KeyboardInterrupt):
        print("interrupted", file=sys.stderr)
        sys.exit(130)
    except BrokenPipeError:
        sys.exit(0)
    except OSError as e:
        print(f"febkit: {e.filename or ''}: {e.strerror or e}".replace(": : ", ": "), file=sys.stderr)
        sys.exit(2)
    except Exception as e:
        source = sys.modules.get("febkit.model.source")  # who raises its error has imported it; help has not
        if source is None or not isinstance(e, source.InputError):
            raise
        print(f"febkit: {e}", file=sys.stderr)
        sys.exit(2)


if __name__ == "__main__":
    main()
