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
    "openvdb": (".vdb",),
    "zarr": (".zarr.zip",),
    "coded_pixels": ("rle.zip", "jpeg_2000.zip", "jpeg_lossless.zip"),
    "transfer_function": (".vp", ".json", ".xml"),
}
MOST = 24
PIXEL_DATA = bytes.fromhex("e07f1000") + b"OB\0\0\xff\xff\xff\xff"
ITEM = bytes.fromhex("feff00e0")
# Places in SYNTAXES of src/dicom.rs.
SYNTAXES = {b"1.2.840.10008.1.2.4.70": 3, b"1.2.840.10008.1.2.4.90": 6, b"1.2.840.10008.1.2.5": 8}


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


def short(data, tag):
    at = data.index(bytes.fromhex(tag) + b"US") + 8
    return int.from_bytes(data[at : at + 2], "little")


def coded_picture(path):
    """The first picture of the first object, after what `object` of src/dicom.rs wants to know of it."""
    data = members(path)[0][1]
    syntax = next(number for uid, number in SYNTAXES.items() if uid in data[:1000])
    table = data.index(PIXEL_DATA) + len(PIXEL_DATA)
    first = table + 8 + int.from_bytes(data[table + 4 : table + 8], "little")
    assert data[first : first + 4] == ITEM, path
    length = int.from_bytes(data[first + 4 : first + 8], "little")
    flags = (short(data, "28000001") == 16) + 4 * short(data, "28000301")
    return bytes([syntax, short(data, "28001000"), short(data, "28001100"), flags]) + data[first + 8 : first + 8 + length]


def belongs(target, path):
    if target in ("zarr", "coded_pixels") or path.parent.name == "transfer":
        return path.name.endswith(SEEDS[target]) and (target == "transfer_function") == (path.parent.name == "transfer")
    if target == "transfer_function":
        return False
    if target == "archives" or not path.name.endswith(SEEDS["archives"]):
        return path.name.endswith(SEEDS[target])
    if target == "dicom":
        return members(path)[0][1][128:132] == b"DICM"
    return members(path)[0][0].endswith(SEEDS[target])


def seed(target, path):
    if target == "coded_pixels":
        return coded_picture(path)
    packed = target != "archives" and path.name.endswith(SEEDS["archives"])
    return as_tar(path) if packed else path.read_bytes()


def main():
    files = sorted(p for folder in ("formats", "geometry", "hostile", "transfer") for p in (DATA / folder).rglob("*") if p.is_file())
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
