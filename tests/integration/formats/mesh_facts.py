"""What VTK reads in a mesh file: mesh_facts.py FILE prints JSON.

points (different ones), triangles, low and high corner; and what the format says of labels:
  .vtp  volume_mm3 and triangles of each label, by BoundaryLabels; its names; its space
  .ply  triangles of each colour
  .obj  triangles of each group (not of materials: VTK 9.1 loses the first)
"""
import collections
import json
import sys

import numpy as np
import vtk
from vtk.util.numpy_support import vtk_to_numpy

READERS = {".vtp": vtk.vtkXMLPolyDataReader, ".ply": vtk.vtkPLYReader, ".stl": vtk.vtkSTLReader, ".obj": vtk.vtkOBJReader}


def boundary_labels(mesh, corners):
    """A triangle's normal points from the first of its two labels to the second: outwards, for the first."""
    sides = vtk_to_numpy(mesh.GetCellData().GetArray("BoundaryLabels"))
    assert sides.dtype == np.uint16 and (sides[:, 0] != 0).all()
    tetrahedra = np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6
    return {
        str(label): {
            "volume_mm3": tetrahedra[sides[:, 0] == label].sum() - tetrahedra[sides[:, 1] == label].sum(),
            "triangles": int((sides == label).any(axis=1).sum()),
        }
        for label in np.unique(sides[sides > 0])
    }


def groups(mesh, path):
    """VTK numbers the groups in the file's order, without their names."""
    with open(path) as file:
        names = [line.split()[1] for line in file if line.startswith("g ")]
    return collections.Counter(names[int(i)] for i in vtk_to_numpy(mesh.GetCellData().GetArray("GroupIds")))


reader = READERS[sys.argv[1][-4:]]()
reader.SetFileName(sys.argv[1])
reader.Update()
mesh = reader.GetOutput()
points = vtk_to_numpy(mesh.GetPoints().GetData()).astype(float)
polygons = vtk_to_numpy(mesh.GetPolys().GetConnectivityArray()).reshape(-1, 3)
facts = {
    "points": len(np.unique(points, axis=0)),
    "triangles": len(polygons),
    "low": points.min(axis=0).tolist(),
    "high": points.max(axis=0).tolist(),
}
cells, field = mesh.GetCellData(), mesh.GetFieldData()
if cells.HasArray("BoundaryLabels"):
    facts["labels"] = boundary_labels(mesh, points[polygons])
    facts["space"] = field.GetAbstractArray("SPACE").GetValue(0)
    names = field.GetAbstractArray("LabelNames")
    values = vtk_to_numpy(field.GetArray("LabelValues"))
    facts["names"] = {str(value): names.GetValue(i) for i, value in enumerate(values)}
if cells.HasArray("RGB"):
    facts["colours"] = collections.Counter(str(tuple(c)) for c in vtk_to_numpy(cells.GetArray("RGB")).tolist())
if cells.HasArray("GroupIds"):
    facts["groups"] = groups(mesh, sys.argv[1])
print(json.dumps(facts))
