"""Writes OpenVDB grids for geometry.py: their voxels come as JSON, since Debian's module is for the interpreter of the system.

    apt-get install python3-openvdb
"""

import itertools
import json
import sys

import pyopenvdb


def main():
    for file in json.load(sys.stdin):
        grid = pyopenvdb.FloatGrid(-1000)
        grid.name = "phantom"
        voxel = grid.getAccessor()
        values = iter(file["values"])
        for at in itertools.product(*map(range, file["size"])):
            voxel.setValueOn(tuple(a + b for a, b in zip(at, file["first"])), next(values))
        grid.transform = pyopenvdb.createLinearTransform(file["matrix"])
        pyopenvdb.write(file["path"], grids=[grid])


main()
