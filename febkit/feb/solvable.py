"""Whether febkit can solve an input, asked in a process of its own.

The solver loads a compiler, and checking an input must not pay for that.

``python -m febkit.feb.solvable model.feb`` prints a JSON list of [severity, message, file, line].
"""

from __future__ import annotations

import json
import subprocess
import sys
from importlib.util import find_spec

from febkit.model import InputError, Where

from .findings import Finding

TIME_LIMIT = 300.0  # s


def ask(path: str) -> list[Finding]:
    """What febkit's solver lacks for the model in ``path``; empty where it can solve it."""
    if find_spec("febkit.lower") is None:
        return [Finding("hint", "febkit is installed without its solver", Where(path))]
    try:
        done = subprocess.run([sys.executable, "-m", "febkit.feb.solvable", path], capture_output=True,
                              text=True, timeout=TIME_LIMIT, check=True)
        rows = json.loads(done.stdout.splitlines()[-1])
    except (subprocess.SubprocessError, ValueError, IndexError) as e:
        stderr = (getattr(e, "stderr", "") or "").strip().splitlines()
        reason = stderr[-1] if stderr else str(e)
        return [Finding("unsupported", f"setting up the solver failed: {reason}", Where(path))]
    return [Finding(severity, message, Where(file, line)) for severity, message, file, line in rows]


def main(path: str) -> list[tuple[str, str, str, int]]:
    from febkit.feb.read import read
    from febkit.lower import unsupported

    found: list[tuple[str, InputError]]
    try:
        found = [("unsupported", refused) for refused in unsupported(read(path))]
    except InputError as error:
        found = [("error", error)]
    out = []
    for severity, said in found:
        where = said.where or Where(path)
        out.append((severity, said.message, where.file, where.line))
    return out


if __name__ == "__main__":
    print(json.dumps(main(sys.argv[1])))
