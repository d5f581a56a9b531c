"""The phantom that every generator writes, and what a reader must find."""

import json
import pathlib
import zipfile

import numpy as np

OUT = pathlib.Path(__file__).resolve().parent.parent / "formats"
NX, NY, NZ = 7, 6, 5


def phantom(least=0, step=13):
    """No flip or swap of axes keeps it: z, y, x."""
    z, y, x = np.mgrid[:NZ, :NY, :NX]
    return least + step * (x + 7 * y) % 251 + 30 * z * z + (x > 3) * 5


def zipped(name, files, compression=zipfile.ZIP_DEFLATED):
    with zipfile.ZipFile(OUT / name, "w", compression) as archive:
        for member, data in files:
            archive.writestr(zipfile.ZipInfo(member), data, compression)


class Expected(dict):
    """Of each file the size, the world step of each index axis, the first voxel's place (mm, LPS) and the values, x
    fastest, with the keys of the scene that select them."""

    def add(self, name, values, steps=((1, 0, 0), (0, 1, 0), (0, 0, 1)), origin=(0, 0, 0), **select):
        values = np.asarray(values)
        self.setdefault(name, []).append(
            {
                "size": list(values.shape[::-1]),
                "steps": np.asarray(steps, float).tolist(),
                "origin": np.asarray(origin, float).tolist(),
                "values": values.ravel().astype(float).tolist(),
                **select,
            }
        )

    def write(self, name):
        (OUT / name).write_text(json.dumps(self) + "\n")
