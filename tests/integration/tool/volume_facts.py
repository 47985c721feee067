"""What other programs read in a label volume: volume_facts.py FILE prints JSON, label -> its ml and its centre in LPS.

NIfTI is read by nibabel; NRRD is unpacked by Teem's unu, whose libraries ITK and 3D Slicer read it with.
"""
import json
import re
import subprocess
import sys

import nibabel
import numpy as np


def nifti(path):
    """Labels [x, y, z] and the way from voxels to LPS."""
    image = nibabel.load(path)
    assert image.header.get_xyzt_units()[0] == "mm" and image.header.get_intent()[0] == "label"
    assert np.allclose(image.get_qform(), image.get_sform())
    return np.asarray(image.dataobj), np.diag([-1, -1, 1, 1]) @ image.affine


def nrrd(path):
    raw = subprocess.run(["teem-unu", "save", "-f", "nrrd", "-e", "raw", "-i", path], check=True, capture_output=True)
    head, voxels = raw.stdout.split(b"\n\n", 1)
    fields = dict(re.findall(r"^([^:#\n]+): (.*)$", head.decode(), re.MULTILINE))
    assert fields["space"] == "left-posterior-superior" and fields["type"] == "unsigned short"
    numbers = [float(n) for n in re.findall(r"[-+.\deE]+", fields["space directions"] + fields["space origin"])]
    to_lps = np.eye(4)
    to_lps[:3] = np.reshape(numbers, (4, 3)).T
    return np.frombuffer(voxels, "<u2").reshape([int(n) for n in fields["sizes"].split()], order="F"), to_lps


labels, to_lps = (nrrd if sys.argv[1].endswith(".nrrd") else nifti)(sys.argv[1])
facts = {}
for label in np.unique(labels[labels > 0]):
    voxels = np.argwhere(labels == label)
    centre = to_lps @ np.append(voxels.mean(axis=0), 1)
    ml = len(voxels) * abs(np.linalg.det(to_lps[:3, :3])) / 1000
    facts[str(label)] = {"ml": ml, "centre": centre[:3].tolist()}
print(json.dumps(facts))
