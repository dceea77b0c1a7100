"""The force on a node set against time, from a plotfile."""

import febkit

ds = febkit.open_results("plug.xplt")
force = ds.febkit.reaction("top").sel(xyz="z")
force.plot()
