//! Files that are known, but not read: what they are, and what to do.

use std::path::Path;

use super::source::bad;
use crate::error::Error;

/// First bytes, what starts so, and a way to a format that is read.
const KNOWN: &[(&[u8], &str, &str)] = &[
    (
        b"\x89HDF\r\n\x1a\n",
        "HDF5 (or NetCDF-4, MINC 2, Imaris, MATLAB 7.3)",
        "write the data set with numpy.save as .npy, or with its spacing as .nrrd",
    ),
    (
        b"CDF",
        "NetCDF",
        "write the variable with numpy.save as .npy",
    ),
    (b"# vtk DataFile", "legacy VTK", "write image data as .vti"),
    (
        b"NanoVDB",
        "NanoVDB",
        "convert it to .vdb with nanovdb_convert",
    ),
    (
        b"MATLAB 5.0",
        "MATLAB",
        "write the array with scipy.io and numpy.save as .npy",
    ),
    (
        b"7z\xbc\xaf\x27\x1c",
        "7-Zip",
        "pack the files as .zip or .tar.gz",
    ),
    (b"Rar!\x1a\x07", "RAR", "pack the files as .zip or .tar.gz"),
    (
        b"\x28\xb5\x2f\xfd",
        "Zstandard",
        "unpack it, or pack it as .gz",
    ),
    (b"BZh", "bzip2", "unpack it, or pack it as .gz"),
];

/// Data sets of VTK's XML files that are no grid of voxels.
const VTK_TYPES: &[&str] = &[
    "StructuredGrid",
    "UnstructuredGrid",
    "RectilinearGrid",
    "PolyData",
    "HyperTreeGrid",
    "PImageData",
    "vtkMultiBlockDataSet",
];

/// Why a file that starts so is not read, if it is known.
pub(super) fn why(path: &Path, head: &[u8]) -> Option<Error> {
    let known = KNOWN.iter().find(|(magic, ..)| head.starts_with(magic));
    if let Some((_, name, advice)) = known {
        return Some(bad(path, format!("{name} files are not read; {advice}")));
    }
    let text = String::from_utf8_lossy(head);
    let (_, tag) = text.split_once("<VTKFile")?;
    let kind = VTK_TYPES
        .iter()
        .find(|kind| tag.contains(&format!("\"{kind}\"")))?;
    Some(bad(
        path,
        format!(
            "VTK data of type {kind} are not read: only ImageData (.vti) has its voxels on a regular grid. \
             vtkResampleToImage (in ParaView: Resample To Image) writes such"
        ),
    ))
}
