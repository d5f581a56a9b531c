#!/usr/bin/env python3
"""Fills fuzz/corpus with small files of the tests, one folder for each target.

What archives hold is repacked as a plain tar: a fuzzer cannot get past checksums of packed data.
"""

import io
import pathlib
import tarfile
import zipfile

FUZZ = pathlib.Path(__file__).resolve().parent
DATA = FUZZ.parent / "tests/data"
# Endings of a target's seeds, or of the members of an archive that is one.
SEEDS = {
    "nrrd": (".nrrd", ".nhdr"),
    "nifti": (".nii", ".nii.gz", ".hdr"),
    "metaimage": (".mha", ".mhd"),
    "dicom": (".dcm",),
    "pictures": (".png",),
    "tiff": (".tif",),
    "numpy": (".npy", ".npz"),
    "fits": (".fits",),
    "vti": (".vti",),
    "archives": (".zip", ".tar.gz", ".tar.xz"),
    "raw": (".raw",),
}
MOST = 16


def members(path):
    if path.name.endswith(".zip"):
        with zipfile.ZipFile(path) as archive:
            return [(name, archive.read(name)) for name in archive.namelist()]
    with tarfile.open(path) as archive:
        return [(m.name, archive.extractfile(m).read()) for m in archive.getmembers()]


def as_tar(path):
    out = io.BytesIO()
    with tarfile.open(fileobj=out, mode="w") as archive:
        for name, data in members(path):
            info = tarfile.TarInfo(name)
            info.size = len(data)
            archive.addfile(info, io.BytesIO(data))
    return out.getvalue()


def belongs(target, path):
    if target == "archives" or not path.name.endswith(SEEDS["archives"]):
        return path.name.endswith(SEEDS[target])
    if target == "dicom":
        return members(path)[0][1][128:132] == b"DICM"
    return members(path)[0][0].endswith(SEEDS[target])


def seed(target, path):
    packed = target != "archives" and path.name.endswith(SEEDS["archives"])
    return as_tar(path) if packed else path.read_bytes()


def main():
    files = sorted(p for folder in ("formats", "geometry", "hostile") for p in (DATA / folder).rglob("*") if p.is_file())
    for target in SEEDS:
        corpus = FUZZ / "corpus" / target
        corpus.mkdir(parents=True, exist_ok=True)
        seeds = [seed(target, path) for path in files if belongs(target, path)]
        # The smallest: what a fuzzer does with a file takes as long as the file.
        seeds.sort(key=len)
        for number, data in enumerate(seeds[:MOST]):
            (corpus / f"seed{number:02}").write_bytes(data)
        print(f"{target}: {min(len(seeds), MOST)} seeds")


main()
