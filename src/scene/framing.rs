//! What of a volume can be seen, and the camera that shows all of it.

use glam::DVec3;
use rayon::prelude::*;

use super::camera::{AUTO_FOV_Y, Projection, View, auto_axes};
use super::{Camera, Curve, Framed, Scene};
use crate::error::Result;
use crate::volume::{Envelope, Volume, Voxel, Voxels, with_typed};

/// Cells along the longest axis of the volume.
const CELLS: u32 = 48;
/// Mean opacity of a cell's voxels, each over the length of one, from which on the cell counts as visible: less is
/// noise or the faintest veil.
const MIN_OPACITY: f64 = 2e-3;
/// Entries of the look-up table of opacities of real numbers.
const TABLE: usize = 1 << 14;
/// Share of the picture's half width and height that what is seen fills at most.
const FILL: f64 = 0.94;

/// The part of a volume that a transfer function shows.
pub(super) struct Visible {
    /// Lowest and highest corner of each visible cell, voxel index.
    cells_ix: Vec<[DVec3; 2]>,
    world_from_ix: glam::DAffine3,
}

impl Visible {
    pub(super) fn of(volume: &Volume, curve: &Curve) -> Self {
        let opacity = opacity_of_stored(volume, curve);
        let size = volume.size();
        let edge = cell_edges(volume);
        let counts: [u32; 3] = std::array::from_fn(|a| size[a].div_ceil(edge[a]));
        let [across, down, deep] = counts;
        let slabs = (0..deep).into_par_iter().flat_map_iter(|z| {
            let sums = slab_sums(volume, &opacity, edge, z);
            let cells = (0..down).flat_map(move |y| (0..across).map(move |x| [x, y, z]));
            cells
                .zip(sums)
                .filter_map(move |(cell, sum)| {
                    let first: [u32; 3] = std::array::from_fn(|a| cell[a] * edge[a]);
                    let end: [u32; 3] = std::array::from_fn(|a| (first[a] + edge[a]).min(size[a]));
                    let voxels: f64 = (0..3).map(|a| f64::from(end[a] - first[a])).product();
                    // Cells meet between voxels; the field ends at the outermost ones.
                    let low = first.map(|n| (f64::from(n) - 0.5).max(0.0));
                    let high: [f64; 3] = std::array::from_fn(|a| {
                        (f64::from(end[a]) - 0.5).min(f64::from(size[a] - 1))
                    });
                    let shown = sum > MIN_OPACITY * voxels;
                    shown.then(|| [low, high].map(DVec3::from_array))
                })
                .collect::<Vec<_>>()
        });
        Self {
            cells_ix: slabs.collect(),
            world_from_ix: volume.world_from_ix(),
        }
    }

    /// Number of voxels in visible cells.
    pub(super) fn voxels(&self) -> f64 {
        let size = |&[low, high]: &[DVec3; 2]| (high - low).element_product();
        self.cells_ix.iter().map(size).sum()
    }

    /// Corners of the visible cells, world.
    fn corners_ws(&self) -> impl Iterator<Item = DVec3> + '_ {
        self.cells_ix.iter().flat_map(move |&[low, high]| {
            (0..8u8).map(move |corner| {
                let pick = |axis: usize| match corner >> axis & 1 {
                    0 => low[axis],
                    _ => high[axis],
                };
                let corner_ix = DVec3::new(pick(0), pick(1), pick(2));
                self.world_from_ix.transform_point3(corner_ix)
            })
        })
    }

    /// Size of the box in the world that holds what is visible, mm; `None` when nothing is.
    pub(super) fn extent_ws(&self) -> Option<DVec3> {
        let (low, high) = self.corners_ws().fold(
            (DVec3::INFINITY, DVec3::NEG_INFINITY),
            |(low, high), corner| (low.min(corner), high.max(corner)),
        );
        low.is_finite().then(|| high - low)
    }

    /// The nearest perspective view along a direction in which the picture holds every corner; `None` when nothing
    /// is visible.
    fn view(&self, azimuth: f64, elevation: f64, zoom: f64, size: [u32; 2]) -> Option<View> {
        let [right, up, backward] = auto_axes(azimuth, elevation);
        let [width, height] = size.map(f64::from);
        let tan_y = (0.5 * AUTO_FOV_Y.to_radians()).tan();
        let tangents = [tan_y * FILL * width / height, tan_y * FILL];
        // The eye is where the outermost planes through corners meet: for each side of the picture, `depth + offset
        // / tangent` is largest at the corner that touches it.
        let mut reach = [[f64::NEG_INFINITY; 2]; 2];
        for corner in self.corners_ws() {
            let depth = corner.dot(backward);
            for (axis, across) in [right, up].into_iter().enumerate() {
                let offset = corner.dot(across) / tangents[axis];
                reach[axis][0] = reach[axis][0].max(depth + offset);
                reach[axis][1] = reach[axis][1].max(depth - offset);
            }
        }
        let place = |axis: usize| 0.5 * (reach[axis][0] - reach[axis][1]) * tangents[axis];
        let distance = |axis: usize| 0.5 * (reach[axis][0] + reach[axis][1]);
        let eye = right * place(0) + up * place(1) + backward * distance(0).max(distance(1));
        eye.is_finite().then(|| View {
            eye,
            right,
            up,
            forward: -backward,
            projection: Projection::Perspective {
                fov_y: 2.0 * (tan_y / zoom).atan(),
            },
        })
    }
}

impl Scene {
    /// The view of the scene's picture. [`Framed::Visible`] frames what `curve` shows of `volume`, or all of it where that
    /// is nothing.
    ///
    /// # Errors
    /// As [`Camera::validate`].
    pub fn view(&self, volume: &Volume, curve: &Curve) -> Result<View> {
        let whole = self.camera.view(volume, self.image.size)?;
        let Camera::Auto {
            azimuth,
            elevation,
            zoom,
            frame: Framed::Visible,
        } = self.camera
        else {
            return Ok(whole);
        };
        let framed = Visible::of(volume, curve).view(azimuth, elevation, zoom, self.image.size);
        Ok(framed.unwrap_or(whole))
    }
}

/// Opacity over the length of one voxel, of each stored value.
struct StoredOpacity {
    table: Vec<f32>,
    lowest: f64,
    per_value: f64,
    /// Stored values below the first and above the last have none.
    shown: [f64; 2],
}

impl StoredOpacity {
    fn at(&self, stored: f64) -> f64 {
        let entry = ((stored - self.lowest) * self.per_value + 0.5) as usize;
        self.table.get(entry).copied().unwrap_or(0.0).into()
    }

    /// True only where no stored value of a range has any opacity.
    fn is_none(&self, [low, high]: [f32; 2]) -> bool {
        let [first, last] = self.shown;
        f64::from(high) < first || f64::from(low) > last
    }
}

fn opacity_of_stored(volume: &Volume, curve: &Curve) -> StoredOpacity {
    let [lowest, highest] = volume.stored_range();
    let entries = match volume.voxels() {
        Voxels::F32(_) => TABLE,
        _ => (highest - lowest) as usize + 1,
    };
    let steps = (entries - 1).max(1) as f64;
    let width = (highest - lowest) / steps;
    let voxels_per_unit = volume.min_spacing() / curve.unit_distance;
    let opacity = |entry: usize| {
        let value = volume.value_from_stored(lowest + width * entry as f64);
        let opacity = curve.evaluate(value).opacity;
        (1.0 - (1.0 - opacity).powf(voxels_per_unit)) as f32
    };
    let table: Vec<f32> = (0..entries).map(opacity).collect();
    let first = table.iter().position(|&o| o > 0.0).unwrap_or(entries);
    let last = table.iter().rposition(|&o| o > 0.0).unwrap_or(0);
    // An entry more on either side, against rounding.
    let shown = [first as f64 - 1.0, last as f64 + 1.0].map(|entry| lowest + width * entry);
    StoredOpacity {
        table,
        lowest,
        per_value: if width > 0.0 { 1.0 / width } else { 0.0 },
        shown,
    }
}

/// Voxels on each axis of a cell that is about as long on all of them in the world.
fn cell_edges(volume: &Volume) -> [u32; 3] {
    let (size, spacing) = (volume.size(), volume.spacing());
    let lengths: [f64; 3] = std::array::from_fn(|a| f64::from(size[a]) * spacing[a]);
    let cell = lengths.into_iter().fold(0.0, f64::max) / f64::from(CELLS);
    spacing.map(|s| (cell / s).round().max(1.0) as u32)
}

/// Sum of the opacities in each cell of a slab of cells, x fastest.
fn slab_sums(volume: &Volume, opacity: &StoredOpacity, edge: [u32; 3], slab: u32) -> Vec<f64> {
    with_typed!(volume.voxels(), voxels => typed_sums(voxels, volume.size(), opacity, edge, slab))
}

fn typed_sums<V: Voxel + PartialOrd>(
    voxels: &[V],
    size: [u32; 3],
    opacity: &StoredOpacity,
    edge: [u32; 3],
    slab: u32,
) -> Vec<f64> {
    let [width, height, depth] = size.map(|n| n as usize);
    let edge = edge.map(|n| n as usize);
    let first = slab as usize * edge[2];
    let planes = first..(first + edge[2]).min(depth);
    let mut envelope = Envelope::default();
    let mut sums = Vec::with_capacity(width.div_ceil(edge[0]) * height.div_ceil(edge[1]));
    for y in (0..height).step_by(edge[1]) {
        let rows = planes
            .clone()
            .flat_map(|k| (y..(y + edge[1]).min(height)).map(move |j| j + height * k))
            .map(|row| &voxels[row * width..][..width]);
        envelope.enclose(rows.clone());
        for x in (0..width).step_by(edge[0]) {
            let columns = x..(x + edge[0]).min(width);
            let sum = |row: &[V]| -> f64 {
                let part = &row[columns.clone()];
                part.iter().map(|v| opacity.at(v.to_f32().into())).sum()
            };
            // Most cells show nothing, and most often that is seen without a look at each voxel.
            sums.push(if opacity.is_none(envelope.range(columns.clone())) {
                0.0
            } else {
                rows.clone().map(sum).sum()
            });
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{ColorManagement, ControlPoint};

    fn point(value: f64, opacity: f64) -> ControlPoint {
        ControlPoint {
            value,
            color: [1.0; 3],
            opacity,
            emission: [0.0; 3],
            source: [0.0; 3],
        }
    }

    #[test]
    fn cells_that_are_passed_over_show_nothing() {
        let (size, edge) = ([23, 19, 12], [4, 3, 5]);
        // Low values, and some high ones.
        let voxels: Vec<i16> = (0..23 * 19 * 12)
            .map(|at: i32| at * 7919 % 5003)
            .map(|noise| if noise < 150 { 20 * noise } else { noise % 50 } as i16)
            .collect();
        let volume = Volume::axis_aligned(Voxels::I16(voxels), size, [1.0; 3]).unwrap();
        let points = [point(999.0, 0.0), point(1000.0, 0.5), point(2000.0, 0.0)];
        let curve = Curve::new(1.0, &points, ColorManagement::Linear);
        let opacity = opacity_of_stored(&volume, &curve);
        let mut passed_over = 0;
        for slab in 0..3 {
            let sums = slab_sums(&volume, &opacity, edge, slab);
            assert_eq!(sums.len(), 6 * 7);
            for (cell, &sum) in (0u32..).zip(&sums) {
                let first = [cell % 6 * edge[0], cell / 6 * edge[1], slab * edge[2]];
                let axis = |a: usize| first[a]..(first[a] + edge[a]).min(size[a]);
                let rows = axis(2).flat_map(|k| axis(1).map(move |j| [j, k]));
                let voxels = rows.flat_map(|[j, k]| axis(0).map(move |i| [i, j, k]));
                let expected: f64 = voxels
                    .map(|[i, j, k]| curve.evaluate(volume.value(i, j, k)).opacity)
                    .sum();
                assert!((sum - expected).abs() <= 1e-5, "{sum} {expected}");
                passed_over += u32::from(expected == 0.0);
            }
        }
        assert!((20..100).contains(&passed_over), "{passed_over} of 126");
    }
}
