//! Scenes as files, for other renderers: voxels as MetaImage on axes of their own, transfer function by its points, an explicit
//! camera, display colours throughout, classification after interpolation.

use std::path::Path;

use umbravox::scene::{
    AmbientOcclusion, Camera, Classification, ColorManagement, ControlPoint, Image, March,
    Projection, Scene, TransferFunction, VolumeSource,
};
use umbravox::volume::{Volume, Voxels};
use umbravox::{Error, Result, output};

use crate::fields::Field;

/// Writes `NAME.mha` and `NAME.json` into `folder`.
///
/// # Errors
/// As [`Field::volume`] and [`output::write_bytes`].
pub(crate) fn write(field: &Field, size: u32, image: u32, folder: &Path) -> Result<()> {
    std::fs::create_dir_all(folder).map_err(|e| Error::io(folder, e))?;
    let volume = field.volume(size)?;
    let unmanaged = ColorManagement::None;
    let curve = field.transfer_function().curve(&volume, unmanaged)?;
    let points = curve.points.iter().map(|point| ControlPoint {
        value: point.value,
        color: point.optical.color,
        opacity: point.optical.opacity,
        emission: point.optical.emission,
        source: point.optical.source,
    });
    let transfer_function = TransferFunction {
        unit_distance: Some(curve.unit_distance),
        points: Some(points.collect()),
        ..Default::default()
    };
    let aligned = Volume::axis_aligned(in_file_units(&volume), volume.size(), volume.spacing())?;
    let name = format!("{}.mha", field.name);
    output::write_bytes(&folder.join(&name), &meta_image(&aligned))?;
    let scene = Scene {
        volume: VolumeSource {
            path: name.into(),
            ..Default::default()
        },
        camera: explicit(&aligned, image)?,
        image: Image {
            size: [image; 2],
            color_management: unmanaged,
            ..Default::default()
        },
        transfer_function,
        march: March {
            classification: Some(Classification::Post),
            ..Default::default()
        },
        lighting: Default::default(),
        ambient_occlusion: None::<AmbientOcclusion>,
        storage: Default::default(),
    };
    let path = folder.join(format!("{}.json", field.name));
    let text = serde_json::to_string_pretty(&scene).map_err(|e| Error::Encode {
        path: path.clone(),
        message: e.to_string(),
    })?;
    output::write_bytes(&path, text.as_bytes())
}

/// The automatic camera in numbers.
fn explicit(volume: &Volume, image: u32) -> Result<Camera> {
    let view = Camera::default().view(volume, [image; 2])?;
    let Projection::Perspective { fov_y } = view.projection else {
        return Err(Error::invalid(
            "camera",
            "the automatic one has perspective",
        ));
    };
    Ok(Camera::Perspective {
        eye: view.eye.to_array(),
        target: (view.eye + view.forward).to_array(),
        up: view.up.to_array(),
        fov_y: fov_y.to_degrees(),
    })
}

/// Voxels after rescale, in the type of the file where that is the same.
fn in_file_units(volume: &Volume) -> Voxels {
    let rescale = volume.rescale();
    if rescale == Default::default() {
        return volume.voxels().clone();
    }
    let voxels = volume.voxels();
    let values = (0..voxels.len()).map(|at| volume.value_from_stored(voxels.get(at)));
    if values.clone().all(|value| f64::from(value as i16) == value) {
        Voxels::I16(values.map(|value| value as i16).collect())
    } else {
        Voxels::F32(values.map(|value| value as f32).collect())
    }
}

fn meta_image(volume: &Volume) -> Vec<u8> {
    let (kind, bytes): (_, Vec<u8>) = match volume.voxels() {
        Voxels::U8(v) => ("MET_UCHAR", v.clone()),
        Voxels::I8(v) => ("MET_CHAR", v.iter().flat_map(|x| x.to_le_bytes()).collect()),
        Voxels::U16(v) => (
            "MET_USHORT",
            v.iter().flat_map(|x| x.to_le_bytes()).collect(),
        ),
        Voxels::I16(v) => (
            "MET_SHORT",
            v.iter().flat_map(|x| x.to_le_bytes()).collect(),
        ),
        Voxels::F32(v) => (
            "MET_FLOAT",
            v.iter().flat_map(|x| x.to_le_bytes()).collect(),
        ),
    };
    let [nx, ny, nz] = volume.size();
    let [dx, dy, dz] = volume.spacing();
    let header = format!(
        "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n\
         CompressedData = False\nOffset = 0 0 0\nDimSize = {nx} {ny} {nz}\n\
         ElementSpacing = {dx} {dy} {dz}\nElementType = {kind}\nElementDataFile = LOCAL\n"
    );
    [header.into_bytes(), bytes].concat()
}
