"""Writes tests/data/geometry: one field in many formats and orientations, each by its format's own library.

    pip install numpy nibabel pynrrd SimpleITK pydicom tifffile pillow astropy imagecodecs vtk zarr
    apt-get install python3-openvdb
    python tests/data/generate/geometry.py

`geometry.json` holds points of the world (mm, LPS) with the value that the formula below has there, in 64-bit floats and
without any reader; and for each file, which of the points it must answer alike.
"""

import gzip
import io
import itertools
import json
import pathlib
import random
import shutil
import subprocess
import tarfile
import tempfile
import zipfile

import numpy as np

OUT = pathlib.Path(__file__).resolve().parent.parent / "geometry"
SIZE = (20, 17, 13)
SPACING = (0.7, 0.9, 1.6)
ORIGIN = np.array([-12.5, 33.25, 100.0])
# Directions of the index axes, columns: a true rotation of no right angle, in numbers that decimal text holds exactly.
OBLIQUE = np.array([[0.8, 0.6, 0.0], [-0.36, 0.48, 0.8], [0.48, -0.64, 0.6]]).T
POINTS = 60
GEOMETRY = {"probes": {}, "outside": {}, "files": []}


# --- the field -------------------------------------------------------------------------------------------------------


def field(i, j, k):
    """Of the base grid's index. Linear along each axis, so that trilinear interpolation has it exactly between voxels
    too; no swap or flip of axes keeps it. Whole numbers at whole i and j and half k."""
    return 100 + 11 * i + 29 * j + 46 * k + 3 * i * j - 2 * j * k + 4 * i * k


def linear(world):
    """Of the world, mm: the same on every grid, however it is turned."""
    return 3.0 * world[0] - 7.0 * world[1] + 11.0 * world[2] - 500.0


def base_voxels():
    """[i, j, k]."""
    return field(*np.mgrid[: SIZE[0], : SIZE[1], : SIZE[2]]).astype(np.int16)


def affine(directions, spacing, origin):
    """World from index, 4 x 4, LPS."""
    matrix = np.eye(4)
    matrix[:3, :3] = np.asarray(directions) * np.asarray(spacing)
    matrix[:3, 3] = origin
    return matrix


def stored(voxels, matrix, order=(0, 1, 2), flips=(0, 0, 0)):
    """The same field with its axes in another order and direction, and where it lies then."""
    flipped, moved = voxels, matrix.copy()
    for axis in range(3):
        if flips[axis]:
            flipped = np.flip(flipped, axis)
            moved[:3, 3] += moved[:3, axis] * (voxels.shape[axis] - 1)
            moved[:3, axis] *= -1
    moved[:3, :3] = moved[:3, list(order)]
    return np.ascontiguousarray(flipped.transpose(order)), moved


def probe_points(name, matrix, value, size=SIZE):
    """Corners and random points with their values; and points around the field, which have none."""
    dice = random.Random(name)
    last = np.array(size) - 1.0
    inside = [np.array(c) * last for c in itertools.product((0, 1), repeat=3)]
    inside += [np.array([dice.uniform(0, n) for n in last]) for _ in range(POINTS)]
    world = lambda at: (matrix @ np.append(at, 1))[:3]
    GEOMETRY["probes"][name] = [[*map(float, world(at)), float(value(at, world(at)))] for at in inside]
    middle = last / 2
    around = []
    for axis in range(3):
        for side in (-0.05, last[axis] + 0.05):
            at = middle.copy()
            at[axis] = side
            around.append(world(at).tolist())
    GEOMETRY["outside"][name] = around


def expect(path, probes, tolerance=1e-6, **more):
    GEOMETRY["files"].append({"file": path, "probes": probes, "tolerance": tolerance, **more})


def place(path):
    file = OUT / path
    file.parent.mkdir(parents=True, exist_ok=True)
    return str(file)


ORIENTATIONS = [(o, f) for o in itertools.permutations(range(3)) for f in itertools.product((0, 1), repeat=3)]


def label(order, flips):
    """The base axis that each stored axis runs along, and whether in positive or negative direction."""
    return "_".join("xyz"[axis] + "pn"[flips[axis]] for axis in order)


RAS = np.diag([-1.0, -1.0, 1.0, 1.0])
# What single-precision headers lose, in values: 8e-6 mm by 100 a mm.
SINGLE = 2e-3


# --- formats that say where their voxels lie -------------------------------------------------------------------------


def nrrd_file(path, voxels, matrix, space="left-posterior-superior", **header):
    import nrrd

    nrrd.write(place(path), voxels, {"space": space, "space directions": matrix[:3, :3].T,
                                     "space origin": matrix[:3, 3], "encoding": "gzip", **header})


def nrrd_files(base):
    for order, flips in ORIENTATIONS:
        voxels, matrix = stored(base, affine(OBLIQUE, SPACING, ORIGIN), order, flips)
        path = f"nrrd/{label(order, flips)}.nrrd"
        nrrd_file(path, voxels, matrix)
        expect(path, "oblique")
    voxels, matrix = stored(base, affine(OBLIQUE, SPACING, ORIGIN), (2, 0, 1), (0, 1, 0))
    for space, turn in (("right-anterior-superior", RAS), ("left-anterior-superior", np.diag([1.0, -1, 1, 1]))):
        nrrd_file(f"nrrd/{space}.nrrd", voxels, turn @ matrix, space)
        expect(f"nrrd/{space}.nrrd", "oblique")
    nrrd_file("nrrd/big.nrrd", voxels.astype(">i2"), matrix)
    expect("nrrd/big.nrrd", "oblique")
    nrrd_file("nrrd/detached.nhdr", voxels, matrix, encoding="raw")
    expect("nrrd/detached.nhdr", "oblique")


def nifti_files(base):
    import nibabel

    def write(path, voxels, matrix, s=1, q=1, kind=nibabel.Nifti1Image, wrong_q=False, endian="<"):
        header = kind.header_class(endianness=endian)
        header.set_data_dtype(voxels.dtype.newbyteorder(endian))
        image = kind(voxels, None, header)
        ras = RAS @ matrix
        image.header.set_zooms(np.linalg.norm(matrix[:3, :3], axis=0))
        image.set_qform(RAS if wrong_q else ras, code=q, strip_shears=True) if q else image.set_qform(None, code=0)
        image.set_sform(ras, code=s) if s else image.set_sform(None, code=0)
        nibabel.save(image, place(path))

    matrix = affine(OBLIQUE, SPACING, ORIGIN)
    # Half of the orientations, as many turned as mirrored.
    for number, (order, flips) in enumerate(o for n, o in enumerate(ORIENTATIONS) if (n + n // 8 + sum(o[1])) % 2):
        form = "sq"[number // 2 % 2]
        path = f"nifti/{form}form_{label(order, flips)}.nii.gz"
        write(path, *stored(base, matrix, order, flips), s=form == "s", q=form == "q")
        expect(path, "oblique", SINGLE)
    turned = stored(base, matrix, (1, 2, 0), (1, 0, 0))
    write("nifti/sform_wins.nii.gz", *turned, s=2, q=1, wrong_q=True)
    write("nifti/big_endian.nii.gz", *turned, endian=">")
    write("nifti/two.nii.gz", *turned, kind=nibabel.Nifti2Image)
    write("nifti/two_q_big.nii.gz", *turned, s=0, kind=nibabel.Nifti2Image, endian=">")
    for name in ("sform_wins.nii.gz", "big_endian.nii.gz", "two.nii.gz", "two_q_big.nii.gz"):
        expect(f"nifti/{name}", "oblique", SINGLE)
    write("nifti/pair.img", *turned, kind=nibabel.Nifti1Pair)
    expect("nifti/pair.hdr", "oblique", SINGLE)
    expect("nifti/pair.img", "oblique", SINGLE)
    # Stored 2 v + 30, said to be 0.5 stored - 15.
    voxels, at = turned
    image = nibabel.Nifti1Image(2 * voxels + 30, RAS @ at)
    image.header["scl_slope"], image.header["scl_inter"] = 0.5, -15
    pathlib.Path(place("nifti/scaled.nii")).write_bytes(scaled_nifti(image, 2 * voxels + 30))
    squeeze("nifti/scaled.nii")
    expect("nifti/scaled.nii.gz", "oblique", SINGLE)
    # Neither form: nothing is said but the sizes of voxels.
    write("nifti/no_form.nii.gz", base, affine(np.eye(3), SPACING, (0, 0, 0)), s=0, q=0)
    expect("nifti/no_form.nii.gz", "at_origin", SINGLE)


def scaled_nifti(image, voxels):
    """nibabel rescales by itself: header and voxels are put together here, header bytes are its own."""
    header = image.header.copy()
    header.set_data_dtype(np.int16)
    header["magic"], header["vox_offset"] = b"n+1", 352
    return bytes(header.binaryblock) + b"\0" * 4 + voxels.astype("<i2").tobytes(order="F")


def squeeze(path):
    file = pathlib.Path(place(path))
    pathlib.Path(place(path + ".gz")).write_bytes(gzip.compress(file.read_bytes(), 9, mtime=0))
    file.unlink()


def sitk_image(voxels, matrix):
    import SimpleITK as sitk

    image = sitk.GetImageFromArray(np.ascontiguousarray(voxels.transpose(2, 1, 0)))
    lengths = np.linalg.norm(matrix[:3, :3], axis=0)
    image.SetSpacing(lengths.tolist())
    image.SetDirection((matrix[:3, :3] / lengths).ravel().tolist())
    image.SetOrigin(matrix[:3, 3].tolist())
    return image


def metaimage_files(base):
    import SimpleITK as sitk

    matrix = affine(OBLIQUE, SPACING, ORIGIN)
    for order, flips in ORIENTATIONS[::4] + ORIENTATIONS[1::8]:
        path = f"metaimage/{label(order, flips)}.mha"
        sitk.WriteImage(sitk_image(*stored(base, matrix, order, flips)), place(path), True)
        expect(path, "oblique")
    sitk.WriteImage(sitk_image(*stored(base, matrix, (2, 1, 0), (0, 0, 1))), place("metaimage/detached.mhd"), True)
    expect("metaimage/detached.mhd", "oblique")
    # The other libraries' formats by ITK, which knows them all.
    turned = sitk_image(*stored(base, matrix, (1, 0, 2), (1, 1, 0)))
    for path, tolerance in (("itk/turned.nrrd", 1e-6), ("itk/turned.nii.gz", SINGLE)):
        sitk.WriteImage(turned, place(path), True)
        expect(path, "oblique", tolerance)


def vti_files(base):
    import vtk
    from vtk.util.numpy_support import numpy_to_vtk

    matrix = affine(OBLIQUE, SPACING, ORIGIN)
    for number, (order, flips) in enumerate(ORIENTATIONS[::6] + ORIENTATIONS[3::12]):
        voxels, at = stored(base, matrix, order, flips)
        lengths = np.linalg.norm(at[:3, :3], axis=0)
        # An extent that does not start at 0: its first voxel lies away from the origin.
        start = np.array([number % 3, 0, -number])
        image = vtk.vtkImageData()
        image.SetExtent(*np.array([start, start + voxels.shape - np.array([1, 1, 1])]).T.ravel().tolist())
        image.SetSpacing(*lengths)
        image.SetDirectionMatrix(*(at[:3, :3] / lengths).ravel())
        image.SetOrigin(*(at[:3, 3] - at[:3, :3] @ start))
        array = numpy_to_vtk(voxels.ravel(order="F"), deep=True)
        array.SetName("density")
        image.GetPointData().SetScalars(array)
        writer = vtk.vtkXMLImageDataWriter()
        path = f"vti/{label(order, flips)}.vti"
        writer.SetInputData(image)
        writer.SetFileName(place(path))
        writer.SetCompressorTypeToZLib()
        writer.EncodeAppendedDataOff()
        writer.Write()
        expect(path, "oblique")


def vdb_files(base):
    """Half of the orders of the axes, each with other flips; the first voxel is no corner of the tree."""
    files = []
    matrix = affine(OBLIQUE, SPACING, ORIGIN)
    for number, (order, flips) in enumerate(ORIENTATIONS[::5]):
        voxels, moved = stored(base, matrix, order, flips)
        path = f"vdb/{label(order, flips)}.vdb"
        first = (-3, 5 * number, 117)
        moved[:3, 3] -= moved[:3, :3] @ np.array(first)
        # Row vectors.
        files.append({"path": place(path), "size": voxels.shape, "first": first, "matrix": moved.T.tolist(),
                      "values": voxels.astype(float).ravel().tolist()})
        expect(path, "oblique")
    script = pathlib.Path(__file__).with_name("geometry_vdb.py")
    subprocess.run(["/usr/bin/python3", script], input=json.dumps(files), text=True, check=True)


def zarr_files(base):
    """Arrays with their axes of space in every order, named; scale and translation in micrometres."""
    import zarr

    matrix = affine(np.eye(3), SPACING, ORIGIN)
    for number, order in enumerate(itertools.permutations(range(3))):
        version = (2, 3)[number % 2]
        names = ["xyz"[axis] for axis in order]
        axes = [{"name": name, "type": "space", "unit": "micrometer"} for name in names]
        scale = [1000 * SPACING[axis] for axis in order]
        translation = [1000 * ORIGIN[axis] for axis in order]
        transforms = [{"type": "scale", "scale": scale}, {"type": "translation", "translation": translation}]
        image = {"axes": axes, "datasets": [{"path": "0", "coordinateTransformations": transforms}]}
        path = f"zarr/{''.join(names)}.zarr.zip"
        with tempfile.TemporaryDirectory() as folder:
            group = zarr.open_group(folder, mode="w", zarr_format=version)
            if version == 2:
                group.attrs["multiscales"] = [{**image, "version": "0.4"}]
            else:
                group.attrs["ome"] = {"version": "0.5", "multiscales": [image]}
            group.create_array("0", data=np.ascontiguousarray(base.transpose(order)), chunks=(7, 6, 5))
            root = pathlib.Path(folder)
            with zipfile.ZipFile(place(path), "w") as archive:
                for file in sorted(f for f in root.rglob("*") if f.is_file()):
                    archive.writestr(zipfile.ZipInfo(file.relative_to(root).as_posix()), file.read_bytes())
        expect(path, "moved")


# --- DICOM -----------------------------------------------------------------------------------------------------------


def dicom(pixels, matrix, k, number, **more):
    """One slice, pixels [row, column], of a grid whose third axis counts slices."""
    import pydicom
    from pydicom.dataset import Dataset, FileMetaDataset
    from pydicom.uid import CTImageStorage, ExplicitVRLittleEndian

    meta = FileMetaDataset()
    meta.TransferSyntaxUID = ExplicitVRLittleEndian
    meta.MediaStorageSOPClassUID = CTImageStorage
    meta.MediaStorageSOPInstanceUID = f"1.2.7.{number}"
    d = Dataset()
    d.file_meta = meta
    d.SOPClassUID, d.SOPInstanceUID = CTImageStorage, f"1.2.7.{number}"
    d.SeriesInstanceUID, d.InstanceNumber, d.Modality = "1.2.7", number, "CT"
    d.Rows, d.Columns = pixels.shape[-2:]
    d.SamplesPerPixel, d.PhotometricInterpretation = 1, "MONOCHROME2"
    d.BitsAllocated, d.BitsStored, d.HighBit, d.PixelRepresentation = 16, 16, 15, 1
    lengths = np.linalg.norm(matrix[:3, :3], axis=0)
    row, column, _ = (matrix[:3, :3] / lengths).T
    text = lambda numbers: [float(f"{v:.12g}") for v in numbers]
    d.PixelSpacing = text([lengths[1], lengths[0]])
    d.ImageOrientationPatient = text([*row, *column])
    d.ImagePositionPatient = text(matrix[:3, 3] + k * matrix[:3, 2])
    for key, value in more.items():
        setattr(d, key, value)
    d.PixelData = pixels.astype("<i2").tobytes()
    d["PixelData"].VR = "OW"
    return d


def saved(d):
    out = io.BytesIO()
    d.save_as(out, enforce_file_format=True)
    return out.getvalue()


def dicom_tar(path, files):
    """A series as an archive, packed by xz: slices one by one would not pack."""
    with tarfile.open(place(path), "w:xz") as archive:
        for name, data in files:
            info = tarfile.TarInfo(name)
            info.size = len(data)
            archive.addfile(info, io.BytesIO(data))


def slices(voxels):
    """[row, column] pictures along the third axis."""
    return [voxels[:, :, k].T for k in range(voxels.shape[2])]


def dicom_files(base):
    matrix = affine(OBLIQUE, SPACING, ORIGIN)
    for order, flips in ORIENTATIONS[2::7]:
        voxels, at = stored(base, matrix, order, flips)
        files = [(f"im{k:03}", saved(dicom(p, at, k, k + 1))) for k, p in enumerate(slices(voxels))]
        path = f"dicom/{label(order, flips)}.tar.xz"
        dicom_tar(path, files)
        expect(path, "oblique")
    pictures = slices(base)
    count = len(pictures)
    dice = random.Random("names")
    names = [f"{name:04x}" for name in dice.sample(range(1 << 16), count)]
    shuffled = list(zip(names, (saved(dicom(p, matrix, k, k + 1)) for k, p in enumerate(pictures))))
    dice.shuffle(shuffled)
    dicom_tar("dicom/shuffled_names.tar.xz", shuffled)
    # Last slice first by number and by name.
    dicom_tar("dicom/reversed.tar.xz",
              [(f"{count - k:02}", saved(dicom(p, matrix, k, count - k))) for k, p in enumerate(pictures)])
    scaled = [(f"{k}", saved(dicom(2 * (p - 300), matrix, k, k, RescaleSlope="0.5", RescaleIntercept="300")))
              for k, p in enumerate(pictures)]
    dicom_tar("dicom/rescaled.tar.xz", scaled)
    own = [(f"{k}", saved(dicom((p - 10 * k) * (1 + k % 2), matrix, k, k, RescaleSlope=1 / (1 + k % 2),
                                RescaleIntercept=10 * k))) for k, p in enumerate(pictures)]
    dicom_tar("dicom/rescale_of_each_slice.tar.xz", own)
    for name in ("shuffled_names", "reversed", "rescaled", "rescale_of_each_slice"):
        expect(f"dicom/{name}.tar.xz", "oblique")

    dicom_tar("dicom/missing_slices.tar.xz",
              [(f"{k}", saved(dicom(p, matrix, k, k))) for k, p in enumerate(pictures) if k not in (3, 4, 9)])
    expect("dicom/missing_slices.tar.xz", "oblique", resampled=True)
    i, j = np.mgrid[: SIZE[0], : SIZE[1]]
    places = [0, 1, 2, 2.5, 3.5, 4.5, 6, 7, 8, 9.5, 10.5, 11, 12]
    dicom_tar("dicom/uneven.tar.xz",
              [(f"{n}", saved(dicom(field(i, j, k).T, matrix, k, n))) for n, k in enumerate(places)])
    expect("dicom/uneven.tar.xz", "oblique", resampled=True)

    sheared = tilted(matrix)
    dicom_tar("dicom/gantry_tilt.tar.xz", [(f"{k}", saved(dicom(p, sheared, k, k))) for k, p in enumerate(pictures)])
    expect("dicom/gantry_tilt.tar.xz", "tilted")
    enhanced(pictures, matrix)


def tilted(matrix):
    """A gantry that leans: each slice is moved along its columns."""
    sheared = matrix.copy()
    sheared[:3, 2] += 0.4 * OBLIQUE[:, 1]
    return sheared


def enhanced(pictures, matrix):
    """One object of many frames, last slice first, places in functional groups."""
    from pydicom.dataset import Dataset
    from pydicom.sequence import Sequence

    count = len(pictures)
    d = dicom(np.stack(pictures[::-1]), matrix, 0, 1, NumberOfFrames=count)
    measures, orientation, shared = Dataset(), Dataset(), Dataset()
    measures.PixelSpacing, measures.SliceThickness = d.PixelSpacing, 99
    orientation.ImageOrientationPatient = d.ImageOrientationPatient
    shared.PixelMeasuresSequence, shared.PlaneOrientationSequence = Sequence([measures]), Sequence([orientation])
    del d.PixelSpacing, d.ImageOrientationPatient, d.ImagePositionPatient
    d.SharedFunctionalGroupsSequence = Sequence([shared])
    frames = []
    for k in reversed(range(count)):
        frame, position = Dataset(), Dataset()
        position.ImagePositionPatient = [float(f"{v:.12g}") for v in matrix[:3, 3] + k * matrix[:3, 2]]
        frame.PlanePositionSequence = Sequence([position])
        frames.append(frame)
    d.PerFrameFunctionalGroupsSequence = Sequence(frames)
    dicom_tar("dicom/enhanced.tar.xz", [("enhanced.dcm", saved(d))])
    expect("dicom/enhanced.tar.xz", "oblique")


# --- formats without an orientation ----------------------------------------------------------------------------------


def unoriented_files(base):
    """x is the column of a picture, y its row from the top, z its number; voxel (0,0,0) is the origin."""
    import tifffile
    from astropy.io import fits
    from PIL import Image

    zyx = np.ascontiguousarray(base.transpose(2, 1, 0)).astype(np.uint16)
    with zipfile.ZipFile(place("unoriented/png.zip"), "w") as archive:
        for k, picture in enumerate(zyx):
            out = io.BytesIO()
            Image.fromarray(picture).save(out, "png")
            archive.writestr(zipfile.ZipInfo(f"slice{k + 7}.png"), out.getvalue())
    np.savez_compressed(place("unoriented/c_order.npz"), zyx)
    np.save(place("unoriented/fortran.npy"), np.asfortranarray(zyx.astype(np.int32)))
    fits.PrimaryHDU(zyx.astype(np.int16)).writeto(place("unoriented/cube.fits"), overwrite=True)
    for name in ("png.zip", "c_order.npz", "fortran.npy", "cube.fits"):
        expect(f"unoriented/{name}", "unit")
    tifffile.imwrite(place("unoriented/pages.ome.tif"), zyx, compression="zlib", photometric="minisblack",
                     metadata={"axes": "ZYX", **{f"PhysicalSize{a}{u}": v for a, s in zip("XYZ", SPACING)
                                                 for u, v in (("", s), ("Unit", "mm"))}})
    tifffile.imwrite(place("unoriented/imagej.tif"), zyx, imagej=True, compression="zlib",
                     resolution=(1 / SPACING[0], 1 / SPACING[1]),
                     metadata={"axes": "ZYX", "spacing": SPACING[2], "unit": "mm"})
    zyx.astype(">u2").tofile(place("unoriented/big_endian.raw"))
    expect("unoriented/pages.ome.tif", "at_origin")
    # Resolution is a fraction of 32-bit numbers there.
    expect("unoriented/imagej.tif", "at_origin", SINGLE)
    expect("unoriented/big_endian.raw", "at_origin",
           raw={"size": SIZE, "type": "u16", "spacing": SPACING, "endian": "big"})


# --- a grid turned against all others --------------------------------------------------------------------------------


def turned_grid():
    """The linear field on a grid turned by 40 degrees about (1, 2, 3)."""
    axis, angle = np.array([1.0, 2, 3]) / np.sqrt(14), np.radians(40)
    cross = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    rotation = np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
    matrix = affine(rotation, (1.3, 0.8, 1.1), (4.0, -21.0, 63.0))
    size = (14, 16, 12)
    index = np.stack([*np.mgrid[: size[0], : size[1], : size[2]], np.ones(size)])
    world = np.einsum("ab,bijk->aijk", matrix, index)
    return size, matrix, linear(world).astype(np.float32)


def turned_files():
    import nibabel
    import SimpleITK as sitk

    size, matrix, voxels = turned_grid()
    probe_points("turned", matrix, lambda _, world: linear(world), size)
    nrrd_file("turned/a.nrrd", voxels, matrix)
    sitk.WriteImage(sitk_image(voxels, matrix), place("turned/a.mha"), True)
    for form in "sq":
        image = nibabel.Nifti1Image(voxels, None)
        image.header.set_zooms((1.3, 0.8, 1.1))
        image.set_sform(RAS @ matrix if form == "s" else None, code=int(form == "s"))
        image.set_qform(RAS @ matrix if form == "q" else None, code=int(form == "q"))
        nibabel.save(image, place(f"turned/{form}.nii.gz"))
    # A thirty-second is what 16 bits hold of this range.
    shift = float(voxels.min())
    whole = np.round((voxels - shift) * 32).astype(np.int16)
    files = [(f"{k}", saved(dicom(p, matrix, k, k, RescaleSlope=1 / 32, RescaleIntercept=f"{shift:.8g}")))
             for k, p in enumerate(slices(whole))]
    dicom_tar("turned/a.tar.xz", files)
    for name, tolerance in (("a.nrrd", 2e-4), ("a.mha", 2e-4), ("s.nii.gz", 5e-4), ("q.nii.gz", 5e-4),
                            ("a.tar.xz", 1 / 60)):
        expect(f"turned/{name}", "turned", tolerance)


def main():
    shutil.rmtree(OUT, ignore_errors=True)
    OUT.mkdir()
    base = base_voxels()
    of_index = lambda at, _: field(*at)
    oblique = affine(OBLIQUE, SPACING, ORIGIN)
    probe_points("oblique", oblique, of_index)
    probe_points("tilted", tilted(oblique), of_index)
    probe_points("at_origin", affine(np.eye(3), SPACING, (0, 0, 0)), of_index)
    probe_points("moved", affine(np.eye(3), SPACING, ORIGIN), of_index)
    probe_points("unit", np.eye(4), of_index)
    for write in (nrrd_files, nifti_files, metaimage_files, vti_files, vdb_files, zarr_files, dicom_files,
                  unoriented_files):
        write(base)
    turned_files()
    (OUT / "geometry.json").write_text(json.dumps(GEOMETRY, separators=(",", ":")) + "\n")


main()
