//! What every format must say: how many voxels, and where they are.

use std::path::Path;

use glam::{DAffine3, DMat3, DVec3};

use super::decoded::Decoded;
use super::element::Element;
use super::source;
use super::{Limits, ReadOptions};
use crate::error::{Error, Result};
use crate::volume::{MIN_SIZE, Rescale, Volume};

/// Directions whose parallelepiped is flatter than this, relative to their lengths, span no space.
const MIN_RELATIVE_VOLUME: f64 = 1e-6;

/// A checked number of voxels of a checked type.
#[derive(Clone, Copy, Debug)]
pub(super) struct Grid {
    /// Voxels on x, y, z; x is fastest.
    pub(super) size: [u32; 3],
    /// Product of `size`.
    pub(super) voxels: usize,
    /// Bytes of them in the file, uncompressed.
    pub(super) bytes: u64,
    /// Bytes of the volumes before this one, in a file that holds several.
    pub(super) bytes_before: u64,
    /// Bytes of all volumes of the file.
    pub(super) all_bytes: u64,
}

impl Grid {
    /// Checks the sizes of what is one volume, whatever time step is asked for.
    pub(super) fn of_one(
        path: &Path,
        key: &str,
        axes: [u64; 3],
        element: Element,
        limits: &Limits,
    ) -> Result<Self> {
        let options = ReadOptions {
            limits: *limits,
            ..ReadOptions::default()
        };
        Self::new(path, key, &axes, element, &options)
    }

    /// Checks the sizes of all axes that a header gives under `key`: three, and others that count volumes, of
    /// which `options` picks one.
    pub(super) fn new(
        path: &Path,
        key: &str,
        axes: &[u64],
        element: Element,
        options: &ReadOptions<'_>,
    ) -> Result<Self> {
        let bad = |message: String| source::bad(path, format!("{key} {axes:?}: {message}"));
        let (&[x, y, z], others) = axes
            .split_first_chunk::<3>()
            .ok_or_else(|| bad(format!("{} axes; a 3-D volume is needed", axes.len())))?;
        let mut size = [0u32; 3];
        for ((axis, wanted), name) in size
            .iter_mut()
            .zip([x, y, z])
            .zip(["first", "second", "third"])
        {
            *axis = u32::try_from(wanted)
                .ok()
                .filter(|&n| n >= MIN_SIZE)
                .ok_or_else(|| {
                    bad(format!(
                        "the {name} axis has {wanted} voxels; valid are {MIN_SIZE} to {}",
                        u32::MAX
                    ))
                })?;
        }
        let volumes = others.iter().fold(1u64, |n, &m| n.saturating_mul(m));
        let volume = u64::from(options.timestep.unwrap_or(0));
        if volume >= volumes {
            return Err(bad(format!(
                "volume.timestep {volume} of {volumes} volumes; the first is 0"
            )));
        }
        if volumes > 1 && options.timestep.is_none() {
            tracing::info!("{volumes} volumes, the first is read; volume.timestep picks another");
        }
        let voxels = x.checked_mul(y).and_then(|n| n.checked_mul(z));
        let bytes = voxels.and_then(|n| n.checked_mul(element.bytes()));
        let (Some(voxels), Some(bytes)) = (voxels, bytes) else {
            return Err(bad("more voxels than can be counted".into()));
        };
        let (Some(all_bytes), Some(bytes_before)) =
            (bytes.checked_mul(volumes), bytes.checked_mul(volume))
        else {
            return Err(bad("more volumes than can be counted".into()));
        };
        let limits = &options.limits;
        if voxels > limits.max_voxels || bytes > limits.max_bytes {
            return Err(bad(format!(
                "{voxels} voxels in {bytes} bytes; the limits are {} voxels and {} bytes",
                limits.max_voxels, limits.max_bytes
            )));
        }
        let voxels = usize::try_from(voxels)
            .map_err(|_| bad("more voxels than this machine can address".into()))?;
        Ok(Self {
            size,
            voxels,
            bytes,
            bytes_before,
            all_bytes,
        })
    }
}

/// World (mm, LPS) from voxel index: the step along each index axis, and voxel (0,0,0). `keys` are the header's
/// names of where they come from.
pub(super) fn placement(
    path: &Path,
    keys: &str,
    steps_ws: [DVec3; 3],
    origin_ws: DVec3,
) -> Result<DAffine3> {
    let bad = |message: String| Err(source::bad(path, format!("{keys}: {message}")));
    if !(origin_ws.is_finite() && steps_ws.iter().all(|s| s.is_finite())) {
        return bad(format!(
            "all numbers must be finite, got axis steps {} and origin {origin_ws}",
            list(&steps_ws)
        ));
    }
    let [x, y, z] = steps_ws;
    let matrix = DMat3::from_cols(
        x.normalize_or_zero(),
        y.normalize_or_zero(),
        z.normalize_or_zero(),
    );
    if matrix.determinant().abs() < MIN_RELATIVE_VOLUME {
        return bad(format!(
            "the axis steps {} span no space; none may be 0 or lie in the plane of the others",
            list(&steps_ws)
        ));
    }
    Ok(DAffine3::from_mat3_translation(
        DMat3::from_cols(x, y, z),
        origin_ws,
    ))
}

fn list(vectors: &[DVec3]) -> String {
    let all: Vec<String> = vectors.iter().map(DVec3::to_string).collect();
    all.join(" ")
}

/// Checks distances between voxels: finite and above 0.
pub(super) fn positive_spacing(path: &Path, key: &str, spacing: [f64; 3]) -> Result<DVec3> {
    if spacing.iter().all(|s| s.is_finite() && *s > 0.0) {
        return Ok(DVec3::from_array(spacing));
    }
    Err(source::bad(
        path,
        format!("{key} {spacing:?}: distances between voxels must be finite and above 0"),
    ))
}

/// Puts a volume together; what it refuses is the file's fault.
pub(super) fn volume(
    path: &Path,
    voxels: impl Into<Decoded>,
    grid: Grid,
    world_from_ix: DAffine3,
    rescale: Rescale,
) -> Result<Volume> {
    let (voxels, colors) = voxels.into().into_parts(grid.size)?;
    Volume::new(voxels, grid.size, world_from_ix, rescale)
        .and_then(|volume| volume.with_colors(colors))
        .map_err(|error| match error {
            Error::Invalid { at, message } => source::bad(path, format!("{at}: {message}")),
            other => other,
        })
}
