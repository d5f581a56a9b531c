//! Label maps: a whole number at every voxel that names the segment it belongs to.

use std::collections::{BTreeMap, BTreeSet};

use glam::{DAffine3, DVec3};
use rayon::prelude::*;

use super::{Volume, Voxels};
use crate::error::{Error, Result};

/// Most different labels of a map.
pub const MAX_LABELS: usize = 1 << 16;
/// Voxels that one task looks at.
const CHUNK: usize = 1 << 20;

/// Where each voxel's label stands in [`LabelMap::labels`], x fastest.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum LabelIndices {
    /// Of up to 256 labels.
    U8(Vec<u8>),
    /// Of more.
    U16(Vec<u16>),
}

/// A segmentation on a grid of its own, placed in the world. A voxel's label holds for all that is nearest to it;
/// beyond the grid the label is 0, the background.
#[derive(Clone, Debug)]
pub struct LabelMap {
    indices: LabelIndices,
    size: [u32; 3],
    world_from_ix: DAffine3,
    labels: Vec<i32>,
    names: BTreeMap<i32, String>,
}

impl LabelMap {
    /// The values of a volume as labels.
    ///
    /// # Errors
    /// [`Error::Invalid`] when a value is not a whole number of 32 bits, or there are more than [`MAX_LABELS`] different ones.
    pub fn new(volume: &Volume) -> Result<Self> {
        if volume.non_finite() > 0 {
            return Err(refused(format!(
                "{} voxels are not numbers",
                volume.non_finite()
            )));
        }
        let labels = match volume.voxels() {
            Voxels::U8(v) => labels_of(volume, v)?,
            Voxels::I8(v) => labels_of(volume, v)?,
            Voxels::U16(v) => labels_of(volume, v)?,
            Voxels::I16(v) => labels_of(volume, v)?,
            Voxels::F32(v) => labels_of(volume, v)?,
        };
        let indices = match volume.voxels() {
            Voxels::U8(v) => indices_of(volume, v, &labels)?,
            Voxels::I8(v) => indices_of(volume, v, &labels)?,
            Voxels::U16(v) => indices_of(volume, v, &labels)?,
            Voxels::I16(v) => indices_of(volume, v, &labels)?,
            Voxels::F32(v) => indices_of(volume, v, &labels)?,
        };
        Ok(Self {
            indices,
            size: volume.size(),
            world_from_ix: volume.world_from_ix(),
            labels,
            names: volume.metadata().label_names.clone(),
        })
    }

    /// Every label that there is: 0 first, there or not; then the others, ascending.
    pub fn labels(&self) -> &[i32] {
        &self.labels
    }

    /// What the file calls a label.
    pub fn name(&self, label: i32) -> Option<&str> {
        self.names.get(&label).map(String::as_str)
    }

    /// Where a label stands in [`LabelMap::labels`].
    pub fn index_of(&self, label: i32) -> Option<usize> {
        find(&self.labels, label)
    }

    /// By voxel.
    pub fn indices(&self) -> &LabelIndices {
        &self.indices
    }

    /// Voxels on x, y, z.
    pub fn size(&self) -> [u32; 3] {
        self.size
    }

    /// World position (mm, LPS) from voxel index.
    pub fn world_from_ix(&self) -> DAffine3 {
        self.world_from_ix
    }

    /// Index position in the map's grid from one in the grid of a volume.
    pub fn ix_from(&self, volume: &Volume) -> DAffine3 {
        self.world_from_ix.inverse() * volume.world_from_ix()
    }

    /// Where the label at an index position in the map's grid stands in [`LabelMap::labels`]: that of the nearest voxel, halves
    /// up; 0 beyond the voxels.
    pub fn index_at(&self, ix: DVec3) -> usize {
        let nearest = (ix + 0.5).floor();
        let size = DVec3::from_array(self.size.map(f64::from));
        if !(nearest.cmpge(DVec3::ZERO) & nearest.cmplt(size)).all() {
            return 0;
        }
        let [i, j, k] = nearest.to_array().map(|x| x as usize);
        let [nx, ny, _] = self.size.map(|n| n as usize);
        let at = i + nx * (j + ny * k);
        match &self.indices {
            LabelIndices::U8(v) => v[at].into(),
            LabelIndices::U16(v) => v[at].into(),
        }
    }

    /// Checks that the map lies where a volume is.
    ///
    /// # Errors
    /// [`Error::Invalid`] when a face of one of the two grids separates them.
    pub fn check_overlap(&self, volume: &Volume) -> Result<()> {
        let ix_from_volume = self.ix_from(volume);
        let apart = separated(ix_from_volume, volume.size(), self.size)
            || separated(ix_from_volume.inverse(), self.size, volume.size());
        if !apart {
            return Ok(());
        }
        let [map, image] = [
            (self.world_from_ix, self.size),
            (volume.world_from_ix(), volume.size()),
        ]
        .map(|(placement, size)| {
            let [low, high] = bounds(placement, size);
            format!("from {low:.1} to {high:.1} mm")
        });
        Err(refused(format!(
            "the labels lie {map}, the volume {image}; give labels that lie where the volume does"
        )))
    }
}

fn refused(message: String) -> Error {
    Error::invalid("volume.labels", message)
}

/// 0 comes first, so that it needs no look-up; the others ascend.
fn find(labels: &[i32], label: i32) -> Option<usize> {
    match label {
        0 => Some(0),
        _ => labels[1..].binary_search(&label).ok().map(|at| at + 1),
    }
}

fn label_of(volume: &Volume, stored: impl Into<f64>) -> Result<i32> {
    let value = volume.value_from_stored(stored.into());
    let label = value as i32;
    if f64::from(label) == value {
        return Ok(label);
    }
    Err(refused(format!(
        "{value} is no label; labels are whole numbers from {} to {}",
        i32::MIN,
        i32::MAX
    )))
}

/// Labels come in runs: a look-up a run.
fn runs<T: PartialEq>(voxels: &[T]) -> impl Iterator<Item = &[T]> {
    voxels.chunk_by(|a, b| a == b)
}

fn labels_of<T: Copy + PartialEq + Into<f64> + Sync>(
    volume: &Volume,
    voxels: &[T],
) -> Result<Vec<i32>> {
    let checked = |found: BTreeSet<i32>| {
        if found.len() <= MAX_LABELS {
            return Ok(found);
        }
        Err(refused(format!(
            "there are more than {MAX_LABELS} different values; is this an image?"
        )))
    };
    let others = voxels
        .par_chunks(CHUNK)
        .map(|chunk| {
            let mut found = BTreeSet::new();
            for run in runs(chunk) {
                found.insert(label_of(volume, run[0])?);
            }
            found.remove(&0);
            Ok(found)
        })
        .try_reduce(BTreeSet::new, |mut all, found| {
            all.extend(found);
            checked(all)
        })?;
    let labels: Vec<i32> = std::iter::once(0).chain(others).collect();
    if labels.len() > MAX_LABELS {
        return Err(refused(format!(
            "there are {} different values and 0; {MAX_LABELS} can be told apart",
            labels.len() - 1
        )));
    }
    Ok(labels)
}

fn indices_of<T: Copy + PartialEq + Into<f64> + Sync>(
    volume: &Volume,
    voxels: &[T],
    labels: &[i32],
) -> Result<LabelIndices> {
    Ok(if labels.len() <= 1 << 8 {
        LabelIndices::U8(narrowed(volume, voxels, labels, |at| at as u8)?)
    } else {
        LabelIndices::U16(narrowed(volume, voxels, labels, |at| at as u16)?)
    })
}

fn narrowed<T: Copy + PartialEq + Into<f64> + Sync, I: Copy + Default + Send>(
    volume: &Volume,
    voxels: &[T],
    labels: &[i32],
    narrow: impl Fn(usize) -> I + Sync,
) -> Result<Vec<I>> {
    let mut indices = Vec::new();
    indices
        .try_reserve_exact(voxels.len())
        .map_err(|e| Error::OutOfMemory {
            heap: "host",
            what: "labels".into(),
            bytes: size_of_val(voxels) as u64,
            detail: e.to_string(),
        })?;
    indices.resize(voxels.len(), I::default());
    indices
        .par_chunks_mut(CHUNK)
        .zip(voxels.par_chunks(CHUNK))
        .try_for_each(|(to, from)| {
            let mut at = 0;
            for run in runs(from) {
                let label = label_of(volume, run[0])?;
                let index = narrow(find(labels, label).unwrap_or_default());
                to[at..at + run.len()].fill(index);
                at += run.len();
            }
            Ok::<(), Error>(())
        })?;
    Ok(indices)
}

/// The corners of a grid, half a voxel around its voxels.
fn corners(placement: DAffine3, size: [u32; 3]) -> [DVec3; 8] {
    let size = DVec3::from_array(size.map(f64::from));
    std::array::from_fn(|c| {
        let side = DVec3::new((c & 1) as f64, (c >> 1 & 1) as f64, (c >> 2) as f64);
        placement.transform_point3(side * size - 0.5)
    })
}

/// The smallest box along the axes around a placed grid.
fn bounds(placement: DAffine3, size: [u32; 3]) -> [DVec3; 2] {
    let corners = corners(placement, size);
    [DVec3::min, DVec3::max].map(|pick| corners.into_iter().fold(corners[0], pick))
}

/// True when a face of the grid `there` has all of the grid `here` on its far side.
fn separated(there_from_here: DAffine3, here: [u32; 3], there: [u32; 3]) -> bool {
    let [low, high] = bounds(there_from_here, here);
    let size = DVec3::from_array(there.map(f64::from));
    (high.cmple(DVec3::splat(-0.5)) | low.cmpge(size - 0.5)).any()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::volume::Rescale;

    const SIZE: [u32; 3] = [3, 2, 2];

    fn map(voxels: Voxels) -> Result<LabelMap> {
        LabelMap::new(&Volume::axis_aligned(voxels, SIZE, [2.0, 1.0, 1.0])?)
    }

    fn message(voxels: Voxels) -> String {
        map(voxels).unwrap_err().to_string()
    }

    #[test]
    fn labels_are_looked_up_at_the_nearest_voxel() {
        let voxels = vec![7i16, 7, -3, 0, 0, 9, 9, 9, 9, 9, 9, 9];
        let map = map(Voxels::I16(voxels)).unwrap();
        assert_eq!(map.labels(), [0, -3, 7, 9]);
        let label = |x: f64, y: f64, z: f64| map.labels()[map.index_at(DVec3::new(x, y, z))];
        assert_eq!(
            [
                label(0.0, 0.0, 0.0),
                label(1.49, 0.0, 0.0),
                label(1.5, 0.0, 0.0)
            ],
            [7, 7, -3],
            "halves go up"
        );
        assert_eq!([label(2.0, 0.6, 0.0), label(0.0, 1.0, 1.4)], [9, 9]);
        assert_eq!(
            [
                label(-0.51, 0.0, 0.0),
                label(2.5, 0.0, 0.0),
                label(0.0, 0.0, f64::NAN)
            ],
            [0; 3],
            "beyond the voxels"
        );
        assert_eq!(
            [map.index_of(7), map.index_of(0), map.index_of(1)],
            [Some(2), Some(0), None]
        );
    }

    #[test]
    fn what_is_no_label_is_refused() {
        let mut voxels = vec![1.0f32; 12];
        voxels[3] = 1.5;
        assert_eq!(
            message(Voxels::F32(voxels.clone())),
            "volume.labels: 1.5 is no label; labels are whole numbers from -2147483648 to 2147483647"
        );
        voxels[3] = f32::NAN;
        assert_eq!(
            message(Voxels::F32(voxels.clone())),
            "volume.labels: 1 voxels are not numbers"
        );
        voxels[3] = 3e9;
        assert!(message(Voxels::F32(voxels)).contains("3000000000 is no label"));
    }

    #[test]
    fn indices_are_as_wide_as_there_are_labels() {
        for (labels, wide) in [(256, false), (257, true), (MAX_LABELS, true)] {
            let values = (0..labels as u32 * 4).map(|n| (n / 4) as f32).collect();
            let size = [labels as u32, 2, 2];
            let volume = Volume::axis_aligned(Voxels::F32(values), size, [1.0; 3]).unwrap();
            let map = LabelMap::new(&volume).unwrap();
            assert_eq!(map.labels().len(), labels);
            assert_eq!(matches!(map.indices(), LabelIndices::U16(_)), wide);
            assert_eq!(
                map.index_at(DVec3::from_array(size.map(f64::from)) - 1.0),
                labels - 1
            );
        }
        let values = (1..=(MAX_LABELS as u32) * 4)
            .map(|n| n.div_ceil(4) as f32)
            .collect();
        let volume =
            Volume::axis_aligned(Voxels::F32(values), [MAX_LABELS as u32, 2, 2], [1.0; 3]).unwrap();
        let error = LabelMap::new(&volume).unwrap_err().to_string();
        assert!(
            error.contains("there are 65536 different values and 0"),
            "{error}"
        );
    }

    #[test]
    fn labels_elsewhere_are_refused() {
        let labels = map(Voxels::U8(vec![1; 12])).unwrap();
        let at = |x: f64| {
            let placement = DAffine3::from_translation(DVec3::new(x, 0.0, 0.0));
            Volume::new(
                Voxels::U8(vec![1; 8]),
                [2; 3],
                placement,
                Rescale::default(),
            )
            .unwrap()
        };
        // The map reaches from -1 to 5 mm, the volume half a voxel around its own.
        for x in [-2.4, 0.0, 5.4] {
            labels.check_overlap(&at(x)).unwrap();
        }
        for x in [-2.6, 5.6] {
            let error = labels.check_overlap(&at(x)).unwrap_err().to_string();
            assert!(
                error.contains("the labels lie from [-1.0, -0.5, -0.5] to [5.0, 1.5, 1.5] mm"),
                "{error}"
            );
        }
    }
}
