"""Writes NRRD, MetaImage, NIfTI, VTI and named raw files of channels, colours and several files.

    pip install numpy pynrrd SimpleITK nibabel vtk
    python tests/data/generate/headers.py
"""

import gzip
import io
import lzma
import tempfile
import pathlib

import nibabel
import nrrd
import numpy as np
import SimpleITK as sitk

from phantom import NZ, OUT, Expected, phantom, zipped

EXPECTED = Expected()
SPACING = (0.5, 0.75, 2.0)
STEPS = np.diag(SPACING)
ORIGIN = (-4.0, 5.5, 60.0)
LUMA = (0.2126, 0.7152, 0.0722)


def luminance(rgb):
    return np.floor(rgb[..., :3].astype(np.float32) @ np.array(LUMA, np.float32) + np.float32(0.5))


def zip_of(name, write):
    """Everything that `write` leaves in a folder."""
    with tempfile.TemporaryDirectory() as folder:
        write(pathlib.Path(folder))
        files = sorted(path for path in pathlib.Path(folder).rglob("*") if path.is_file())
        zipped(name, [(path.relative_to(folder).as_posix(), path.read_bytes()) for path in files])


def nrrds():
    p = phantom().astype(np.int16)
    header = {"space": "left-posterior-superior", "space directions": STEPS, "space origin": ORIGIN}
    nrrd.write(str(OUT / "bzip2.nrrd"), p.T, {**header, "encoding": "bzip2"})
    EXPECTED.add("bzip2.nrrd", p, STEPS, ORIGIN)

    # A vector at each voxel, first axis; then the same with the vectors apart.
    vector = np.stack([p, p + 1000, -p])
    none = [[np.nan] * 3]
    nrrd.write(str(OUT / "vector.nrrd"), vector.transpose(0, 3, 2, 1),
               {**header, "space directions": np.vstack([none, STEPS]), "kinds": ["vector", "domain", "domain", "domain"]})
    nrrd.write(str(OUT / "list.nrrd"), vector.transpose(3, 2, 1, 0),
               {**header, "space directions": np.vstack([STEPS, none]), "kinds": ["domain", "domain", "domain", "list"]})
    for name in ("vector.nrrd", "list.nrrd"):
        EXPECTED.add(name, p, STEPS, ORIGIN)
        EXPECTED.add(name, -p, STEPS, ORIGIN, channel=2)

    rgb = np.stack([p % 256, (3 * p) % 256, (7 * p) % 256], -1).astype(np.uint8)
    nrrd.write(str(OUT / "rgb.nrrd"), rgb.transpose(3, 2, 1, 0),
               {**header, "space directions": np.vstack([none, STEPS]),
                "kinds": ["RGB-color", "domain", "domain", "domain"], "encoding": "raw"})
    EXPECTED.add("rgb.nrrd", luminance(rgb), STEPS, ORIGIN)
    EXPECTED.add("rgb.nrrd", rgb[..., 1], STEPS, ORIGIN, channel=1)

    # A file for each slice; SimpleITK is asked whether it finds the same.
    text = (f"NRRD0004\ntype: int16\ndimension: 3\nsizes: {' '.join(map(str, p.shape[::-1]))}\nendian: little\n"
            "spacings: 0.5 0.75 2\n")

    def slices(folder, encoding, pack, data_file):
        for k in range(NZ):
            (folder / f"s_{3 + 2 * k:03}.raw").write_bytes(pack(p[k].tobytes()))
        (folder / "slices.nhdr").write_text(f"{text}encoding: {encoding}\ndata file: {data_file}")
        assert (sitk.GetArrayFromImage(sitk.ReadImage(str(folder / "slices.nhdr"))) == p).all()

    names = "\n".join(f"s_{3 + 2 * k:03}.raw" for k in range(NZ))
    zip_of("nrrd_pattern.zip", lambda folder: slices(folder, "raw", bytes, f"s_%03d.raw 3 {1 + 2 * NZ} 2\n"))
    zip_of("nrrd_list.zip", lambda folder: slices(folder, "gzip", gzip.compress, f"LIST\n{names}\n"))
    for name in ("nrrd_pattern.zip", "nrrd_list.zip"):
        EXPECTED.add(name, p, STEPS)


def metaimages():
    p = phantom().astype(np.uint16)

    def image(array, vector=False):
        image = sitk.GetImageFromArray(array, isVector=vector)
        image.SetSpacing(SPACING)
        image.SetOrigin(ORIGIN)
        return image

    vector = np.stack([p, p + 1000], -1)
    sitk.WriteImage(image(vector, True), str(OUT / "two_channels.mha"), useCompression=True)
    EXPECTED.add("two_channels.mha", p, STEPS, ORIGIN)
    EXPECTED.add("two_channels.mha", p + 1000, STEPS, ORIGIN, channel=1)
    rgb = np.stack([p % 256, (3 * p) % 256, (7 * p) % 256], -1).astype(np.uint8)
    sitk.WriteImage(image(rgb, True), str(OUT / "rgb.mha"))
    EXPECTED.add("rgb.mha", luminance(rgb), STEPS, ORIGIN)
    EXPECTED.add("rgb.mha", rgb[..., 0], STEPS, ORIGIN, channel=0)

    # A header and its data, as SimpleITK writes them, in an archive.
    zip_of("pair.zip", lambda folder: sitk.WriteImage(image(p), str(folder / "ct.mhd")))
    EXPECTED.add("pair.zip", p, STEPS, ORIGIN)

    # A file for each slice; SimpleITK is asked whether it finds the same.
    text = (f"ObjectType = Image\nNDims = 3\nDimSize = {' '.join(map(str, p.shape[::-1]))}\nElementType = MET_USHORT\n"
            "ElementSpacing = 0.5 0.75 2\nElementByteOrderMSB = False\n")

    def slices(folder, data_file):
        for k in range(NZ):
            (folder / f"s{k}.raw").write_bytes(p[k].tobytes())
        (folder / "slices.mhd").write_text(f"{text}ElementDataFile = {data_file}")
        assert (sitk.GetArrayFromImage(sitk.ReadImage(str(folder / "slices.mhd"))) == p).all()

    names = "\n".join(f"s{k}.raw" for k in range(NZ))
    zip_of("meta_pattern.zip", lambda folder: slices(folder, f"s%d.raw 0 {NZ - 1} 1\n"))
    zip_of("meta_list.zip", lambda folder: slices(folder, f"LIST\n{names}\n"))
    for name in ("meta_pattern.zip", "meta_list.zip"):
        EXPECTED.add(name, p, STEPS)


def niftis():
    p = phantom()
    ras = np.diag([-0.5, -0.75, 2.0, 1.0])
    rgb = np.stack([p % 256, (3 * p) % 256, (7 * p) % 256], -1).astype(np.uint8)
    dtype = np.dtype([(c, "u1") for c in "RGB"])
    colours = np.ascontiguousarray(rgb).view(dtype)[..., 0]
    nibabel.save(nibabel.Nifti1Image(colours.T, ras), OUT / "rgb.nii.gz")
    EXPECTED.add("rgb.nii.gz", luminance(rgb), STEPS)
    EXPECTED.add("rgb.nii.gz", rgb[..., 2], STEPS, channel=2)
    waves = (p + 1j * (p + 5)).astype(np.complex64)
    nibabel.save(nibabel.Nifti1Image(waves.T, ras), OUT / "complex.nii.gz")
    EXPECTED.add("complex.nii.gz", p, STEPS)
    EXPECTED.add("complex.nii.gz", p + 5, STEPS, channel=1)


def vtis():
    import vtk
    from vtk.util.numpy_support import numpy_to_vtk

    p = phantom().astype(np.float32)
    image = vtk.vtkImageData()
    image.SetDimensions(*p.shape[::-1])
    image.SetSpacing(*SPACING)
    array = numpy_to_vtk(np.stack([p, p / 2, -p], -1).reshape(-1, 3), deep=True)
    array.SetName("velocity")
    image.GetPointData().AddArray(array)
    writer = vtk.vtkXMLImageDataWriter()
    writer.SetInputData(image)
    writer.SetFileName(str(OUT / "vectors.vti"))
    writer.Write()
    EXPECTED.add("vectors.vti", p, STEPS)
    EXPECTED.add("vectors.vti", -p, STEPS, channel=2)


def raws():
    p = phantom()
    size = "x".join(map(str, p.shape[::-1]))
    for kind, order, suffix in (("uint16", ">", "_big"), ("float32", "<", ""), ("int32", "<", "-le")):
        name = f"phantom_{size}_{kind}{suffix}.raw"
        (OUT / name).write_bytes(p.astype(np.dtype(kind).newbyteorder(order)).tobytes())
        EXPECTED.add(name, p)
    (OUT / f"phantom_{size}_uint8.raw.gz").write_bytes(gzip.compress(p.astype(np.uint8).tobytes(), mtime=0))
    EXPECTED.add(f"phantom_{size}_uint8.raw.gz", p.astype(np.uint8))
    zipped("named_raw.zip", [("readme.txt", b"one volume"), (f"a/p_{size}_uint16.raw", p.astype("<u2").tobytes())])
    EXPECTED.add("named_raw.zip", p)

    # One file, packed.
    out = io.BytesIO()
    np.save(out, p.astype("<u2"))
    (OUT / "one.npy.gz").write_bytes(gzip.compress(out.getvalue(), mtime=0))
    (OUT / "one.npy.xz").write_bytes(lzma.compress(out.getvalue()))
    for name in ("one.npy.gz", "one.npy.xz"):
        EXPECTED.add(name, p)


def main():
    nrrds()
    metaimages()
    niftis()
    vtis()
    raws()
    EXPECTED.write("expected_headers.json")


main()
