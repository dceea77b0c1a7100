"""Tab in IPython and Jupyter: what is behind ``m.materials["cartilage"].solid.`` is known to the objects alone.

IPython completes what it can evaluate without running unknown code, and jedi what stands in sources. So IPython is told
that properties and items of models have no side effects, and given a matcher for the parameters of nodes.
"""

from __future__ import annotations

import re
import sys
from typing import Any

_BEFORE = re.compile(r"([\w.\[\]'\"() ,+-]*[\w\])])\.(\w*)$")  # an expression, a dot, the beginning of a name


def teach() -> None:
    """Tell the IPython that runs, if one does. Older ones, without policies, complete as they can."""
    if "IPython" not in sys.modules:
        return
    try:
        from IPython import get_ipython
        from IPython.core.guarded_eval import EVALUATION_POLICIES

        shell = get_ipython()
        limited: Any = EVALUATION_POLICIES["limited"]
        attributes, items = _known()
        limited.allowed_getattr |= attributes
        limited.allowed_getitem |= items
        if shell is not None and _matcher not in shell.Completer.custom_matchers:
            shell.Completer.custom_matchers.append(_matcher)
    except (ImportError, AttributeError, KeyError):
        return


def _known() -> tuple[set[type], set[type]]:
    """Classes whose properties, and whose items, may be looked at."""
    from . import model, node, output, parts, sets, stage, steps

    attributes: set[type] = {model.Model, node.Node, parts.Part, steps.StepView, output.Outputs}
    items: set[type] = {parts.Materials, parts.Parts, sets.NodeSets, sets.Surfaces, sets.ElementSets, steps.Steps}
    return attributes, items | {stage.Components, node.Node}


def _matcher(context: Any) -> Any:
    """Parameters of a node before the cursor, as IPython's matchers give them."""
    from IPython.core.completer import SimpleCompletion
    from IPython.core.guarded_eval import EvaluationContext, guarded_eval

    from .node import Node

    found = _BEFORE.search(context.text_until_cursor)
    names: list[str] = []
    if found is not None:
        shell = sys.modules["IPython"].get_ipython()
        try:
            where = EvaluationContext(locals=shell.user_ns, globals=shell.user_global_ns, evaluation="limited")
            value = guarded_eval(found[1].strip(), where)
        except Exception:  # whatever the half-written line raises
            value = None
        if isinstance(value, Node):
            names = [n for n in dir(value) if n.startswith(found[2])]
    return {
        "completions": [SimpleCompletion(text=n, type="instance") for n in names],
        "matched_fragment": found[2] if found is not None else "",
        "suppress": bool(names),
    }


_matcher.matcher_api_version = 2  # type: ignore[attr-defined]
