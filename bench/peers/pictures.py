"""Pictures as arrays, and how far two of them agree."""

import math

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOImage import vtkPNGReader


def read_png(path):
    """Display colours, (height, width, 3), 0 to 255; row 0 at the top."""
    reader = vtkPNGReader()
    reader.SetFileName(str(path))
    reader.Update()
    return from_image_data(reader.GetOutput())


def from_image_data(image):
    """The same of a vtkImageData, whose row 0 is at the bottom."""
    width, height, _ = image.GetDimensions()
    pixels = vtk_to_numpy(image.GetPointData().GetScalars()).reshape(height, width, -1)
    return pixels[::-1, :, :3].astype(np.float64)


def psnr_db(one, other):
    """Peak signal-to-noise ratio over all pixels and channels, peak 255; `None` where they are equal."""
    mean_square = float(np.mean((one - other) ** 2))
    return 10.0 * math.log10(255.0**2 / mean_square) if mean_square > 0.0 else None
