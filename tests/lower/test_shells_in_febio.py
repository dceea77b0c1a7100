"""Shells of mixtures against FEBio 4.11's numbers, at the end of runs of these decks with the same steps.

Of membranes FEBio's source was mended first: as released it does not know the species of their reactions
(docs/mixtures.md).
"""

from __future__ import annotations

from pathlib import Path

import pytest

from helpers import shell_deck as s
from helpers.mixture_deck import solve

RIM = s.zero("rim", "xyz") + s.zero("rim", "xyz", "s")
SIDE = s.zero("side", "y") + s.zero("side", "y", "s")
DRAINED = '<bc type="zero fluid pressure" node_set="shell"/>'
BEHIND = s.given("shell fluid pressure", "shell", 0.05, curve=1)
TWO = s.biphasic(1, "s", E=5, k=1e-4) + s.biphasic(2, "m", E=0.5)
INSIDE, OUTSIDE = '<SolidDomain name="B" mat="m"/>', '<SolidDomain name="A" mat="n"/>'
SALT = {1: 100.0, 2: 100.0, 3: 20.0}


def bath(where: str) -> str:
    """A bath that becomes half as strong again."""
    return s.given("fluid pressure", where, s.BATH) + "".join(
        s.given("concentration", where, v, f"c{i}", 2) for i, v in SALT.items()
    )


def membrane(rates: list[str], **species: str) -> str:
    kind = "reversible" if len(rates) > 1 else "forward"
    each = "".join(f'<{tag} species="{v}"><{tag}>1</{tag}></{tag}>' for tag, v in species.items())
    law = "".join(f"<{w}_rate {r}</{w}_rate>" for w, r in zip(("forward", "reverse"), rates))
    return (
        f'<membrane_reaction type="membrane-mass-action-{kind}">{each}<override_vbar>1</override_vbar><Vbar>0</Vbar>'
        f"{law}</membrane_reaction>"
    )


def between(reaction: str = "", within: tuple = s.ALL, kind: str = "quad4") -> str:
    """A charged shell between a more charged solid behind it and one without charges in front, in a bath."""
    made = s.multiphasic(1, "s", within, E=5, k=1e-4, charge=-20, more=reaction)
    made += s.multiphasic(2, "m", E=0.5, charge=-80) + s.multiphasic(3, "n", E=0.5)
    held = s.zero("low", "xyz") + SIDE + bath("high")
    return s.deck(
        made, s.mesh(kind, 2, 2), s.SHELL + INSIDE + OUTSIDE, held, s.starts(SALT), "multiphasic"
    )


CONST = 'type="membrane constant reaction rate"><k>{}</k>'
GATED = 'type="membrane voltage-gated reaction rate"><a>1</a><b>2</b><c>0.01</c><d>0.02</d><sol>1</sol>'
CHANNEL = 'type="membrane ion channel reaction rate"><g>1e-6</g><sol>1</sol>'
DECKS = {
    "quad4 on a solid": s.deck(
        TWO, s.mesh("quad4", 2), s.SHELL + INSIDE,
        s.zero("low", "xyz") + SIDE + DRAINED + s.given("displacement", "shell", -0.05, "z", 1),
    ),
    "tri3 on a solid": s.deck(
        TWO, s.mesh("tri3", 2), s.SHELL + INSIDE,
        s.zero("low", "xyz") + SIDE + DRAINED + s.given("displacement", "shell", -0.05, "z", 1),
    ),
    "tri3 of nine points": s.deck(
        TWO, s.mesh("tri3", 2), s.SHELL.replace('"s"', '"s" elem_type="TRI3G9"') + INSIDE,
        s.zero("low", "xyz") + SIDE + DRAINED + s.given("displacement", "shell", -0.05, "z", 1),
    ),
    "tri3 under a solid": s.deck(
        TWO, s.mesh("tri3", 0, 2), s.SHELL + '<SolidDomain name="A" mat="m"/>',
        s.zero("high", "xyz") + SIDE + s.given("displacement", "shell", -0.05, "z", 1) + BEHIND,
    ),
    "quad8": s.deck(s.biphasic(1, "s"), s.mesh("quad8"), s.SHELL, RIM + DRAINED + BEHIND),
    "tri6, steady": s.deck(
        s.biphasic(1, "s"), s.mesh("tri6"), s.SHELL, RIM + DRAINED + BEHIND, analysis="STEADY-STATE", steps=5
    ),
    "charged": between(),
    "charged tri3": between(kind="tri3"),
    "reversible": between(membrane([CONST.format(0.05), CONST.format(0.02)], vRe="Glc", vPi="Glc"), s.IONS),
    "forward": between(membrane([CONST.format(0.05)], vRi="Glc", vPe="Glc"), kind="tri3"),
    "gated": between(membrane([GATED, GATED], vRi="Na", vPe="Na")),
    "channel": between(membrane([CHANNEL, CHANNEL], vRi="Na", vPe="Na")),
    "from within": between(membrane([CONST.format(0.002), CONST.format(0.001)], vR="Glc", vPi="Glc")),
}  # fmt: skip

#: plot variable -> place in its flat array -> value
FEBIO = {
    "quad4 on a solid": {
        "displacement": {2: -0.05},
        "shell_displacement": {2: -0.04941209, 8: -0.04958287},
        "stress": {0: 0.05788985, 62: -0.07858063},
        "effective_fluid_pressure": {9: 0.02576435, 18: 0.06909865},
        "effective_shell_fluid_pressure": {0: 0.01014453, 1: 0.01709815},
        "fluid_flux": {14: 0.0003176921, 35: 0.001178432},
    },
    "tri3 on a solid": {
        "displacement": {2: -0.05},
        "shell_displacement": {2: -0.04935799, 11: -0.04965346},
        "stress": {0: 0.07321747, 104: -0.08011704},
        "effective_fluid_pressure": {9: 0.03139186, 18: 0.0731137},
        "effective_shell_fluid_pressure": {0: 0.0138493, 1: 0.01726527},
        "fluid_flux": {26: 0.0003732746, 56: 0.001192702},
    },

    "tri3 of nine points": {
        "displacement": {2: -0.05},
        "shell_displacement": {2: -0.04935778, 11: -0.04965346},
        "stress": {0: 0.0732265, 104: -0.08011407},
        "effective_fluid_pressure": {9: 0.03139173, 18: 0.07310607},
        "effective_shell_fluid_pressure": {0: 0.01385362, 1: 0.01726631},
        "fluid_flux": {26: 0.0003733632, 56: 0.001191702},
    },
    "tri3 under a solid": {
        "displacement": {2: -0.05},
        "shell_displacement": {2: -0.05060034, 20: -0.05068117},
        "stress": {0: -0.1321046, 7: -0.2106415},
        "effective_fluid_pressure": {0: -0.06890058, 22: -0.0833689},
        "effective_shell_fluid_pressure": {0: 0.05},
        "fluid_flux": {26: -0.0009832578, 71: 0.001594931},
    },
    "quad8": {
        "displacement": {4: -0.005291665, 5: 0.01614191},
        "shell_displacement": {4: -0.007298686, 5: 0.01558548},
        "stress": {0: -0.01207676, 6: -0.01216694},
        "effective_shell_fluid_pressure": {0: 0.05},
        "fluid_flux": {0: -0.002529551, 11: 0.01092332},
    },
    "tri6, steady": {
        "displacement": {4: -0.00577629, 5: 0.01591374},
        "shell_displacement": {4: -0.007072557, 5: 0.01546544},
        "stress": {0: -0.01056248, 30: -0.01169348},
        "effective_shell_fluid_pressure": {0: 0.05},
        "fluid_flux": {2: 0.01133699, 23: 0.01135481},
    },
    "charged": {
        "displacement": {81: 0.09350137, 121: 0.2020732},
        "shell_displacement": {0: -0.008735569, 26: -0.03825994},
        "stress": {0: 0.09909642, 19: 0.1813061},
        "effective_fluid_pressure": {0: -0.2306686, 29: -0.9059879},
        "effective_shell_fluid_pressure": {0: -0.5918404, 4: -0.659475},
        "fluid_flux": {38: 0.008770821, 59: -0.01824308},
        "effective_solute_concentration": {0: 91.26093, 108: 150},
        "solute_concentration": {0: 113.8288, 12: 149.575},
        "solute_flux": {14: -0.5640718, 173: -2.790109},
        "electric_potential": {0: -6.10958, 10: -14.25924},
    },
    "charged tri3": {
        "displacement": {81: 0.09468692, 125: -0.3425156},
        "shell_displacement": {0: -0.00902816, 26: -0.04027455},
        "stress": {1: -0.09002877, 18: 0.2616031},
        "effective_fluid_pressure": {0: -0.2309952, 29: -0.8862066},
        "effective_shell_fluid_pressure": {0: -0.581455, 5: -0.7151497},
        "fluid_flux": {74: 0.008975829, 104: -0.02471317},
        "effective_solute_concentration": {0: 91.36419, 108: 150},
        "solute_concentration": {0: 114.0592, 27: 150.2072},
        "solute_flux": {218: 1.044235, 308: -3.264996},
        "electric_potential": {0: -6.133204, 9: -14.33358},
    },
    "reversible": {
        "displacement": {81: 0.09327845, 121: 0.2017041},
        "shell_displacement": {0: -0.008049203, 26: -0.0364009},
        "stress": {0: 0.1252124, 19: 0.210861},
        "effective_fluid_pressure": {0: -0.2192191, 29: -0.9075353},
        "effective_shell_fluid_pressure": {0: -0.5991175, 4: -0.6675026},
        "fluid_flux": {38: 0.008932624, 59: -0.01825329},
        "effective_solute_concentration": {0: 91.36459, 108: 150},
        "solute_concentration": {0: 114.0556, 12: 149.4561},
        "solute_flux": {11: -0.5619497, 173: -2.791663},
        "electric_potential": {0: -6.137324, 10: -14.26833},
    },
    "forward": {
        "displacement": {81: 0.0947423, 125: -0.3425086},
        "shell_displacement": {0: -0.008967685, 26: -0.04059618},
        "stress": {1: -0.08955377, 18: 0.2617303},
        "effective_fluid_pressure": {0: -0.238715, 29: -0.8851063},
        "effective_shell_fluid_pressure": {0: -0.5726579, 5: -0.70648},
        "fluid_flux": {74: 0.008907779, 104: -0.02469456},
        "effective_solute_concentration": {0: 91.35099, 108: 150},
        "solute_concentration": {0: 114.0539, 27: 150.2161},
        "solute_flux": {8: -0.7230399, 308: -3.263571},
        "electric_potential": {0: -6.133999, 9: -14.33096},
    },
    "gated": {
        "displacement": {81: 0.09350163, 121: 0.2020775},
        "shell_displacement": {0: -0.00873604, 26: -0.03825781},
        "stress": {0: 0.09909353, 19: 0.1813024},
        "effective_fluid_pressure": {0: -0.2305611, 29: -0.9060062},
        "effective_shell_fluid_pressure": {0: -0.5919524, 4: -0.6595663},
        "fluid_flux": {38: 0.008771769, 59: -0.01824336},
        "effective_solute_concentration": {0: 91.21777, 108: 150},
        "solute_concentration": {0: 113.8313, 12: 149.5874},
        "solute_flux": {14: -0.5661386, 173: -2.790262},
        "electric_potential": {0: -6.110179, 10: -14.25225},
    },
    "channel": {
        "displacement": {81: 0.09350146, 121: 0.2020745},
        "shell_displacement": {0: -0.008735715, 26: -0.03825929},
        "stress": {0: 0.09909556, 19: 0.181305},
        "effective_fluid_pressure": {0: -0.2306355, 29: -0.9059936},
        "effective_shell_fluid_pressure": {0: -0.5918751, 4: -0.6595034},
        "fluid_flux": {38: 0.008771114, 59: -0.01824316},
        "effective_solute_concentration": {0: 91.24754, 108: 150},
        "solute_concentration": {0: 113.8296, 12: 149.5788},
        "solute_flux": {14: -0.5647631, 173: -2.790156},
        "electric_potential": {0: -6.109765, 10: -14.25707},
    },
    "from within": {
        "displacement": {81: 0.09350186, 121: 0.2020734},
        "shell_displacement": {0: -0.008738589, 26: -0.03825063},
        "stress": {0: 0.09911143, 19: 0.1813116},
        "effective_fluid_pressure": {0: -0.23077, 29: -0.905972},
        "effective_shell_fluid_pressure": {0: -0.5921566, 4: -0.6597887},
        "fluid_flux": {38: 0.008769695, 59: -0.01824283},
        "effective_solute_concentration": {0: 91.26045, 108: 150},
        "solute_concentration": {0: 113.8282, 12: 149.5748},
        "solute_flux": {14: -0.564115, 173: -2.790089},
        "electric_potential": {0: -6.109595, 10: -14.25988},
    },
}


@pytest.mark.parametrize("name", DECKS)
def test_numbers_are_febio_s(name: str, tmp_path: Path) -> None:
    last = solve(DECKS[name], tmp_path).isel(time=-1)
    for variable, places in FEBIO[name].items():
        flat = last[variable].values.ravel()
        assert {k: float(flat[k]) for k in places} == pytest.approx(places, rel=2e-5), variable
