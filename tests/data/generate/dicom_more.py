"""Writes DICOM series of colours, of JPEG 2000, and of files without a preamble, into tests/data/formats.

    pip install numpy pydicom SimpleITK
    python tests/data/generate/dicom_more.py
"""

import io
import pathlib
import tempfile

import numpy as np
import SimpleITK as sitk
from pydicom.dataset import Dataset, FileMetaDataset
from pydicom.uid import CTImageStorage, ExplicitVRLittleEndian

from phantom import NZ, Expected, phantom, zipped

EXPECTED = Expected()
SPACING = (0.5, 0.75, 2.0)
STEPS = np.diag(SPACING)
LUMA = np.array((0.2126, 0.7152, 0.0722), np.float32)


def saved(pixels, k, series, prefix="whole", implicit=False, **more):
    meta = FileMetaDataset()
    meta.TransferSyntaxUID = ExplicitVRLittleEndian
    meta.MediaStorageSOPClassUID = CTImageStorage
    meta.MediaStorageSOPInstanceUID = f"{series}.{k}"
    d = Dataset()
    d.file_meta = meta
    d.ImageType = ["ORIGINAL", "PRIMARY"]
    d.SOPClassUID, d.SOPInstanceUID = CTImageStorage, f"{series}.{k}"
    d.SeriesInstanceUID, d.InstanceNumber = series, k
    d.Rows, d.Columns = more.pop("shape", pixels.shape[:2])
    d.SamplesPerPixel, d.PhotometricInterpretation = 1, "MONOCHROME2"
    d.BitsAllocated, d.BitsStored, d.HighBit = 8 * pixels.itemsize, 8 * pixels.itemsize, 8 * pixels.itemsize - 1
    d.PixelRepresentation = 0
    d.PixelSpacing = [SPACING[1], SPACING[0]]
    d.ImageOrientationPatient, d.ImagePositionPatient = [1, 0, 0, 0, 1, 0], [0, 0, SPACING[2] * k]
    for key, value in more.items():
        setattr(d, key, value)
    d.PixelData = pixels.tobytes() + b"\0" * (pixels.nbytes % 2)
    d["PixelData"].VR = "OW" if pixels.itemsize > 1 else "OB"
    out = io.BytesIO()
    if prefix == "none":
        del d.file_meta
        d.save_as(out, implicit_vr=implicit, little_endian=True, enforce_file_format=False)
        return out.getvalue()
    d.save_as(out, enforce_file_format=True)
    return out.getvalue()[0 if prefix == "whole" else 132:]


def series(name, slices, values, **select):
    zipped(name, [(f"{k}.dcm", data) for k, data in enumerate(slices)])
    EXPECTED.add(name, values, STEPS, **select)


def main():
    p = phantom()
    rgb = np.stack([p % 256, (3 * p) % 256, (7 * p) % 256], -1).astype(np.uint8)
    luma = np.floor(rgb.astype(np.float32) @ LUMA + np.float32(0.5))
    colour = {"SamplesPerPixel": 3, "PhotometricInterpretation": "RGB", "PlanarConfiguration": 0}
    series("rgb_dicom.zip", [saved(rgb[k], k, "1.2.20", **colour) for k in range(NZ)], luma)
    EXPECTED.add("rgb_dicom.zip", rgb[..., 2], STEPS, channel=2)
    planes = {**colour, "PlanarConfiguration": 1, "shape": p.shape[1:]}
    series("planes_dicom.zip", [saved(np.moveaxis(rgb[k], -1, 0), k, "1.2.21", **planes) for k in range(NZ)], luma)
    EXPECTED.add("planes_dicom.zip", rgb[..., 1], STEPS, channel=1)
    ybr = {**colour, "PhotometricInterpretation": "YBR_FULL"}
    y, cb, cr = np.moveaxis(rgb.astype(np.float32), -1, 0) - np.array([0, 128, 128], np.float32).reshape(3, 1, 1, 1)
    decoded = np.stack([y + 1.402 * cr, y - 0.344136 * cb - 0.714136 * cr, y + 1.772 * cb], -1)
    decoded = np.clip(np.floor(decoded + 0.5), 0, 255)
    ybr_luma = np.floor(decoded.astype(np.float32) @ LUMA + np.float32(0.5))
    series("ybr_dicom.zip", [saved(rgb[k], k, "1.2.22", **ybr) for k in range(NZ)], ybr_luma)

    q = p.astype("<u2")
    series("no_preamble.zip", [saved(q[k], k, "1.2.23", "meta") for k in range(NZ)], q)
    series("no_meta_explicit.zip", [saved(q[k], k, "1.2.24", "none") for k in range(NZ)], q)
    series("no_meta_implicit.zip", [saved(q[k], k, "1.2.25", "none", True) for k in range(NZ)], q)

    # Coded by GDCM, through SimpleITK. The codec needs 32 pixels on an axis.
    big = np.kron(p, np.ones((1, 6, 6))).astype(np.uint16)
    coded = []
    with tempfile.TemporaryDirectory() as folder:
        for k in range(NZ):
            image = sitk.GetImageFromArray(big[k : k + 1])
            image.SetSpacing(SPACING)
            image.SetOrigin((0, 0, SPACING[2] * k))
            for tag, value in (("0020|000e", "1.2.26"), ("0020|0013", str(k)), ("0008|0060", "CT"),
                               ("0020|0037", "1\\0\\0\\0\\1\\0"), ("0020|0032", f"0\\0\\{SPACING[2] * k}")):
                image.SetMetaData(tag, value)
            writer = sitk.ImageFileWriter()
            writer.KeepOriginalImageUIDOn()
            writer.UseCompressionOn()
            writer.SetCompressor("JPEG2000")
            path = f"{folder}/{k}.dcm"
            writer.SetFileName(path)
            writer.Execute(image)
            coded.append(pathlib.Path(path).read_bytes())
    series("jpeg_2000.zip", coded, big)
    EXPECTED.write("expected_dicom.json")


main()
