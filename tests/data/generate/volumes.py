"""Writes tests/data/formats: one small phantom in many formats, each by its field's own library.

    pip install numpy pydicom SimpleITK tifffile pillow astropy imagecodecs nibabel vtk
    python tests/data/generate/volumes.py

Steps and places are those that were asked of the libraries.
"""

import io
import pathlib
import tarfile

import numpy as np

from phantom import NX, NY, NZ, OUT, Expected, phantom, zipped

EXPECTED = Expected()
expect = EXPECTED.add


def tar(name, files, mode):
    with tarfile.open(OUT / name, mode) as archive:
        for member, data in files:
            info = tarfile.TarInfo(member)
            info.size = len(data)
            archive.addfile(info, io.BytesIO(data))


# --- DICOM -----------------------------------------------------------------------------------------------------------

ROW = np.array([0.8, 0.6, 0.0])
COLUMN = np.array([-0.36, 0.48, 0.8])
NORMAL = np.cross(ROW, COLUMN)
DX, DY, DZ = 0.7, 0.9, 2.5
ORIGIN = np.array([-12.5, 33.25, 100.0])


def dicom(pixels, position, number, series="1.2.3", photometric="MONOCHROME2", bits=16, signed=False, **more):
    import pydicom
    from pydicom.dataset import Dataset, FileMetaDataset
    from pydicom.uid import CTImageStorage, ExplicitVRLittleEndian

    meta = FileMetaDataset()
    meta.TransferSyntaxUID = more.pop("syntax", ExplicitVRLittleEndian)
    meta.MediaStorageSOPClassUID = CTImageStorage
    meta.MediaStorageSOPInstanceUID = f"{series}.{number}"
    d = Dataset()
    d.file_meta = meta
    d.SOPClassUID = CTImageStorage
    d.SOPInstanceUID = f"{series}.{number}"
    d.SeriesInstanceUID, d.SeriesNumber, d.InstanceNumber = series, "4", number
    d.SeriesDescription = f"Series {series}"
    d.Rows, d.Columns = pixels.shape[-2:]
    d.SamplesPerPixel, d.PhotometricInterpretation = 1, photometric
    d.BitsAllocated, d.BitsStored, d.HighBit = 8 * pixels.itemsize, bits, bits - 1
    d.PixelRepresentation = int(signed)
    d.PixelSpacing = [DY, DX]
    if position is not None:
        d.ImageOrientationPatient = [float(f"{v:.12g}") for v in (*ROW, *COLUMN)]
        d.ImagePositionPatient = [float(f"{v:.10g}") for v in position]
    for key, value in more.items():
        setattr(d, key, value)
    d.PixelData = pixels.tobytes()
    d["PixelData"].VR = "OW" if pixels.itemsize > 1 else "OB"
    return d


def saved(d):
    out = io.BytesIO()
    d.save_as(out, enforce_file_format=True)
    return out.getvalue()


def steps(slice_step=NORMAL * DZ):
    return [ROW * DX, COLUMN * DY, slice_step]


def dicom_series():
    from pydicom.uid import JPEGLSLossless, RLELossless

    p = phantom()
    at = [ORIGIN + NORMAL * DZ * k for k in range(NZ)]
    order = [3, 0, 4, 1, 2]

    # Out of order, with a scout of another series beside it.
    files = [(f"a/im{n}", saved(dicom(p[k].astype("<i2") - 1000, at[k], n, signed=True, RescaleSlope=2,
                                      RescaleIntercept=-24))) for n, k in enumerate(order)]
    scout = dicom(p[0, :4, :4].astype("<u2"), at[0], 1, series="1.2.9", SeriesNumber="9")
    tar("ct_oblique.tar.gz", files + [("a/scout", saved(scout)), ("a/readme.txt", b"not DICOM")], "w:gz")
    expect("ct_oblique.tar.gz", 2 * (p - 1000) - 24, steps(), ORIGIN)
    tar("ct_oblique.tar.xz", files, "w:xz")
    expect("ct_oblique.tar.xz", 2 * (p - 1000) - 24, steps(), ORIGIN)

    # 12 bits with rubbish above them, white is low.
    rubbish = [(f"{k}.dcm", saved(dicom(p[k].astype("<u2") | 0xA000, at[k], k, bits=12, photometric="MONOCHROME1")))
               for k in range(NZ)]
    zipped("twelve_bit.zip", rubbish)
    expect("twelve_bit.zip", p, steps(), ORIGIN)

    # Slope and intercept of each slice its own.
    own = [(f"{k}.dcm", saved(dicom(p[k].astype("<u2"), at[k], k, RescaleSlope=0.5 + k, RescaleIntercept=-k)))
           for k in range(NZ)]
    zipped("pet_rescale.zip", own)
    k = np.arange(NZ)[:, None, None]
    expect("pet_rescale.zip", p * (0.5 + k) - k, steps(), ORIGIN)

    # A tilted gantry: slices move sideways.
    tilt = NORMAL * DZ + COLUMN * 0.4
    zipped("tilted.zip", [(f"{k}.dcm", saved(dicom(p[k].astype("<u2"), ORIGIN + tilt * k, k))) for k in range(NZ)])
    expect("tilted.zip", p, steps(tilt), ORIGIN)

    # Slice 2 is missing: between linear neighbours nothing is lost.
    ramp = (p[0] + 10 * np.arange(NZ)[:, None, None]).astype("<u2")
    zipped("missing.zip", [(f"{k}.dcm", saved(dicom(ramp[k], at[k], k))) for k in (0, 1, 3, 4)])
    expect("missing.zip", ramp, steps(), ORIGIN)

    # Two times.
    both = [(f"{t}{k}.dcm", saved(dicom((p[k] + 100 * t).astype("<u2"), at[k], 1 + k + 10 * t, AcquisitionNumber=1 + t)))
            for t in range(2) for k in range(NZ)]
    zipped("two_times.zip", both)
    expect("two_times.zip", p, steps(), ORIGIN)
    expect("two_times.zip", p + 100, steps(), ORIGIN, timestep=1)

    coded = []
    for k in range(NZ):
        d = dicom(p[k].astype("<u2"), at[k], k)
        d.compress(RLELossless)
        coded.append((f"{k}.dcm", saved(d)))
    zipped("rle.zip", coded)
    expect("rle.zip", p, steps(), ORIGIN)

    big = []
    for k in range(NZ):
        d = dicom(p[k].astype("<u2"), at[k], k, syntax="1.2.840.10008.1.2.1.99")
        big.append((f"{k}.dcm", saved(d)))
    zipped("deflated.zip", big)
    expect("deflated.zip", p, steps(), ORIGIN)


def dicom_multiframe():
    from pydicom.dataset import Dataset
    from pydicom.sequence import Sequence

    p = phantom()
    d = dicom(p[::-1].astype("<u2"), None, 1, NumberOfFrames=NZ)
    del d.PixelSpacing
    shared, measures, orientation, values = Dataset(), Dataset(), Dataset(), Dataset()
    measures.PixelSpacing, measures.SliceThickness = [DY, DX], DZ
    orientation.ImageOrientationPatient = [*ROW, *COLUMN]
    values.RescaleSlope, values.RescaleIntercept, values.RescaleType = 1, -1024, "HU"
    shared.PixelMeasuresSequence = Sequence([measures])
    shared.PlaneOrientationSequence = Sequence([orientation])
    shared.PixelValueTransformationSequence = Sequence([values])
    d.SharedFunctionalGroupsSequence = Sequence([shared])
    frames = []
    for k in reversed(range(NZ)):
        frame, place = Dataset(), Dataset()
        place.ImagePositionPatient = [float(f"{v:.10g}") for v in ORIGIN + NORMAL * DZ * k]
        frame.PlanePositionSequence = Sequence([place])
        frames.append(frame)
    d.PerFrameFunctionalGroupsSequence = Sequence(frames)
    (OUT / "enhanced.dcm").write_bytes(saved(d))
    expect("enhanced.dcm", p - 1024, steps(), ORIGIN)


def dicom_jpeg_lossless():
    """Coded by GDCM, through SimpleITK."""
    import SimpleITK as sitk
    import tempfile

    p = phantom().astype(np.uint16)
    files = []
    with tempfile.TemporaryDirectory() as folder:
        for k in range(NZ):
            image = sitk.GetImageFromArray(p[k : k + 1])
            image.SetSpacing([DX, DY, DZ])
            image.SetDirection([*np.array([ROW, COLUMN, NORMAL]).T.ravel()])
            image.SetOrigin((ORIGIN + NORMAL * DZ * k).tolist())
            for tag, value in (("0020|000e", "1.2.5"), ("0020|0013", str(k)), ("0008|0060", "CT"),
                               ("0020|0037", "\\".join(f"{v:.12g}" for v in (*ROW, *COLUMN))),
                               ("0020|0032", "\\".join(f"{v:.10g}" for v in ORIGIN + NORMAL * DZ * k))):
                image.SetMetaData(tag, value)
            writer = sitk.ImageFileWriter()
            writer.KeepOriginalImageUIDOn()
            writer.UseCompressionOn()
            writer.SetCompressor("JPEG")
            path = f"{folder}/{k}.dcm"
            writer.SetFileName(path)
            writer.Execute(image)
            files.append((f"{k}.dcm", pathlib.Path(path).read_bytes()))
    zipped("jpeg_lossless.zip", files)
    expect("jpeg_lossless.zip", p, steps(), ORIGIN)


# --- pictures --------------------------------------------------------------------------------------------------------


def pictures():
    import tifffile
    from PIL import Image

    p = phantom()

    def png(array):
        out = io.BytesIO()
        Image.fromarray(array).save(out, "png")
        return out.getvalue()

    # 9 comes before 10.
    zipped("gray8_png.zip", [(f"stack/s{8 + k}.png", png(p[k].astype(np.uint8))) for k in reversed(range(NZ))])
    expect("gray8_png.zip", p.astype(np.uint8))
    zipped("gray16_png.zip", [(f"s{8 + k}.png", png((100 * p[k]).astype(np.uint16))) for k in range(NZ)])
    expect("gray16_png.zip", (100 * p).astype(np.uint16))
    rgb = np.stack([p, p + 1, 2 * p], -1).astype(np.uint8)
    zipped("rgb_png.zip", [(f"s{k}.png", png(rgb[k])) for k in range(NZ)])
    expect("rgb_png.zip", rgb[..., 2], channel=2)

    q = p.astype(np.uint16)
    tifffile.imwrite(OUT / "imagej.tif", q, imagej=True, resolution=(1 / 0.25, 1 / 0.5),
                     metadata={"axes": "ZYX", "spacing": 2.0, "unit": "um"})
    expect("imagej.tif", q, np.diag([0.00025, 0.0005, 0.002]))
    tifffile.imwrite(OUT / "ome.ome.tif", q, compression="zlib", photometric="minisblack",
                     metadata={"axes": "ZYX", "PhysicalSizeX": 0.25, "PhysicalSizeY": 0.5, "PhysicalSizeZ": 2,
                               "PhysicalSizeXUnit": "µm", "PhysicalSizeYUnit": "µm", "PhysicalSizeZUnit": "µm"})
    expect("ome.ome.tif", q, np.diag([0.00025, 0.0005, 0.002]))
    f = (p / 8).astype(np.float32)
    tifffile.imwrite(OUT / "big_float.tif", f, bigtiff=True, byteorder=">", photometric="minisblack", metadata=None)
    expect("big_float.tif", f)
    channels = np.stack([q, q + 1000], 1)
    tifffile.imwrite(OUT / "channels.ome.tif", channels, photometric="minisblack", metadata={"axes": "ZCYX"})
    expect("channels.ome.tif", channels[:, 0])
    expect("channels.ome.tif", channels[:, 1], channel=1)
    pages = []
    for k in range(NZ):
        out = io.BytesIO()
        tifffile.imwrite(out, q[k], compression="lzw", metadata=None)
        pages.append((f"p{k + 8}.tif", out.getvalue()))
    zipped("tiff_folder.zip", pages)
    expect("tiff_folder.zip", q)


# --- arrays ----------------------------------------------------------------------------------------------------------


def arrays():
    from astropy.io import fits

    p = phantom()
    np.save(OUT / "c.npy", p.astype("<i4"))
    expect("c.npy", p)
    np.save(OUT / "fortran.npy", np.asfortranarray(p.astype(">f4")))
    expect("fortran.npy", p)
    four = np.stack([p, p + 500]).astype("<u2")
    np.savez_compressed(OUT / "four.npz", four)
    expect("four.npz", four[0])
    expect("four.npz", four[1], timestep=1)
    np.save(OUT / "half.npy", (p / 4).astype("<f2"))
    expect("half.npy", (p / 4).astype(np.float16))

    fits.PrimaryHDU(p.astype(np.uint16) + 40000).writeto(OUT / "unsigned.fits", overwrite=True)
    expect("unsigned.fits", p + 40000)
    scaled = fits.PrimaryHDU(p.astype(np.int16))
    extension = fits.ImageHDU(p.astype(np.float32) / 4)
    extension.header["CDELT1"], extension.header["CDELT2"], extension.header["CDELT3"] = -0.5, 0.5, 2.0
    fits.HDUList([fits.PrimaryHDU(), extension]).writeto(OUT / "extension.fits", overwrite=True)
    expect("extension.fits", p / 4)


# --- VTK and NIfTI ---------------------------------------------------------------------------------------------------


def vtk_images():
    import vtk
    from vtk.util.numpy_support import numpy_to_vtk

    p = phantom().astype(np.int16)
    direction = np.array([ROW, COLUMN, NORMAL]).T
    for name, mode, compressed in (("ascii", "Ascii", False), ("base64_zlib", "Binary", True),
                                   ("base64", "Binary", False), ("raw", "Appended", False),
                                   ("raw_zlib", "Appended", True)):
        image = vtk.vtkImageData()
        image.SetExtent(2, NX + 1, 0, NY - 1, 0, NZ - 1)
        image.SetSpacing(DX, DY, DZ)
        image.SetOrigin(*ORIGIN)
        image.SetDirectionMatrix(*direction.ravel())
        other = numpy_to_vtk(np.zeros(p.size, np.float32), deep=True)
        other.SetName("other")
        image.GetPointData().AddArray(other)
        array = numpy_to_vtk(p.ravel(), deep=True)
        array.SetName("density")
        image.GetPointData().SetScalars(array)
        writer = vtk.vtkXMLImageDataWriter()
        writer.SetInputData(image)
        writer.SetFileName(str(OUT / f"{name}.vti"))
        getattr(writer, f"SetDataModeTo{mode}")()
        writer.SetCompressorTypeToZLib() if compressed else writer.SetCompressorTypeToNone()
        writer.SetBlockSize(128)
        writer.SetHeaderTypeToUInt64() if name == "raw" else writer.SetHeaderTypeToUInt32()
        writer.EncodeAppendedDataOff()
        writer.Write()
        expect(f"{name}.vti", p, steps(), ORIGIN + 2 * DX * ROW)


def nifti():
    import nibabel

    p = phantom().astype(np.int16)
    affine = np.eye(4)
    affine[:3, :3] = np.array(steps()).T
    affine[:3, 3] = ORIGIN
    # RAS there: x and y change sign.
    ras = np.diag([-1.0, -1, 1, 1]) @ affine
    both = np.stack([p, p + 300]).T
    image = nibabel.Nifti1Image(both, ras)
    image.header.set_slope_inter(1, 0)
    nibabel.save(image, OUT / "two_times.nii.gz")
    expect("two_times.nii.gz", p, steps(), ORIGIN)
    expect("two_times.nii.gz", p + 300, steps(), ORIGIN, timestep=1)


def main():
    OUT.mkdir(exist_ok=True)
    dicom_series()
    dicom_multiframe()
    dicom_jpeg_lossless()
    pictures()
    arrays()
    vtk_images()
    nifti()
    EXPECTED.write("expected.json")


main()
