"""A time series for ParaView."""

import febkit

febkit.open_results("plug.xplt").febkit.write_vtk("plug.pvd")
