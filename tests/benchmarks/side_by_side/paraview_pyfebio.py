"""A series for ParaView, by way of HDF5 and meshio; displacements alone."""

import h5py
import meshio
from pyfebio.xplt import to_hdf5

to_hdf5("febio.xplt", "febio.h5")
with h5py.File("febio.h5") as h:
    nodes, hexes = h["meshes/0/nodes"][:], h["meshes/0/domains/plug"][:][:, 1:]
    X = [(n["x"], n["y"], n["z"]) for n in nodes]
    with meshio.xdmf.TimeSeriesWriter("plug.xdmf") as series:
        series.write_points_cells(X, [("hexahedron", hexes)])
        for k in sorted(h["states"], key=int):
            s = h[f"states/{k}"]
            u = s["node_data/displacement/nodes_1"][:]
            series.write_data(float(s.attrs["time"][0]), point_data={"displacement": u})
