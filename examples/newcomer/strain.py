"""The mean third principal (Green-Lagrange) strain of a part, over time."""

import febkit

ds = febkit.open_results("plug.xplt")
strain = ds.febkit.mean("principal_strain:third", part="plug")
strain.plot()
