//! OME-Zarr 0.4 and 0.5, and Zarr arrays (versions 2 and 3): a folder or a ZIP store.
//!
//! Format: Open Microscopy Environment, *Next-generation file formats*, <https://ngff.openmicroscopy.org>; Zarr
//! developers, *Zarr core specification* 3.0 and *Zarr storage specification* 2, <https://zarr-specs.readthedocs.io>.

mod chunks;
mod codecs;
mod metadata;
mod ome;
mod store;

use glam::DVec3;
use half::f16;

use self::chunks::{Chunks, Selection};
use self::metadata::Array;
use self::ome::{Axes, Multiscale};
use self::store::Store;
use super::bundle::Bundle;
use super::element::Element;
use super::formats::BundleReader;
use super::grid::{self, Grid};
use super::narrow::narrowed;
use super::{Format, ReadOptions};
use crate::error::Result;
use crate::volume::{Rescale, Volume, Voxels};

pub(super) const FORMAT: Format = Format {
    name: "OME-Zarr",
    extensions: &["zarr", "ome.zarr", "zarr.zip"],
    reads: "a level of an image, or an array, Zarr versions 2 and 3; Blosc, Zstandard, gzip, shards",
    file: None,
    bundle: Some(BundleReader {
        recognise: |bundle| store::root(bundle).is_some(),
        read,
    }),
};

/// Most chunks that one volume is put together from.
const MAX_CHUNKS: u64 = 1 << 22;

fn read(bundle: &Bundle, options: &ReadOptions<'_>) -> Result<Volume> {
    let mut store = Store::new(bundle, &options.limits);
    let image = ome::image(&mut store, options)?;
    let level = match &image {
        Some(image) => Level::choose(&store, image, options)?,
        None => Level::alone(&store, options)?,
    };
    if options.strict && !level.axes.has_units {
        let what = "the axes of space have no units, and volume.strict refuses to guess";
        return Err(store.bad("axes", what.into()));
    }
    level.volume(&store, options)
}

/// One array and where it lies.
struct Level {
    path: String,
    array: Array,
    axes: Axes,
    grid: Grid,
    step: DVec3,
    origin: DVec3,
}

impl Level {
    /// The level asked for, else the finest that is within the limits, else the coarsest.
    fn choose(store: &Store<'_>, image: &Multiscale, options: &ReadOptions<'_>) -> Result<Self> {
        let count = image.datasets.len();
        let mut level = options.level.unwrap_or(0) as usize;
        loop {
            let dataset = image.datasets.get(level).ok_or_else(|| {
                store.bad(
                    "multiscales",
                    format!("volume.level {level} of {count} levels; the first and finest is 0"),
                )
            })?;
            let array = Array::read(store, &dataset.path)?;
            let axes = Axes::of(store, &image.axes, array.shape.len())?;
            let may_be_coarser = options.level.is_none() && level + 1 < count;
            if may_be_coarser && !axes.fit(&array, &options.limits) {
                level += 1;
                continue;
            }
            if count > 1 && options.level.is_none() {
                tracing::info!("{count} levels, {level} is read; volume.level picks another");
            }
            let placement = image.placement(store, dataset, &axes, array.shape.len())?;
            return Self::new(store, dataset.path.clone(), array, axes, placement, options);
        }
    }

    /// Of an array without an image around it.
    fn alone(store: &Store<'_>, options: &ReadOptions<'_>) -> Result<Self> {
        let array = Array::read(store, "")?;
        let axes = Axes::of(store, &[], array.shape.len())?;
        Self::new(
            store,
            String::new(),
            array,
            axes,
            [DVec3::ONE, DVec3::ZERO],
            options,
        )
    }

    fn new(
        store: &Store<'_>,
        path: String,
        array: Array,
        axes: Axes,
        [step, origin]: [DVec3; 2],
        options: &ReadOptions<'_>,
    ) -> Result<Self> {
        let sizes = axes.sizes(&array);
        let at = store.path(&path);
        let grid = Grid::of_one(&at, "shape", sizes, array.element, &options.limits)?;
        let chunks = axes.space.iter().zip(sizes).map(|(&axis, size)| {
            let chunk = array.chunk.get(axis).copied().unwrap_or(1);
            size.div_ceil(chunk.max(1))
        });
        let chunks = chunks.fold(1u64, u64::saturating_mul);
        if chunks > MAX_CHUNKS {
            let what = format!(
                "{chunks} chunks of {:?}; {MAX_CHUNKS} are read",
                array.chunk
            );
            return Err(store.bad(&path, what));
        }
        Ok(Self {
            path,
            array,
            grid,
            step: step * axes.unit,
            origin: origin * axes.unit,
            axes,
        })
    }

    fn volume(&self, store: &Store<'_>, options: &ReadOptions<'_>) -> Result<Volume> {
        let selection = Selection {
            fixed: self.fixed(store, options)?,
            space: self.axes.space,
            size: self.grid.size,
        };
        let chunks = Chunks {
            store,
            path: &self.path,
            array: &self.array,
            selection: &selection,
        };
        let path = store.path(&self.path);
        let element = self.array.element;
        let progress = options.progress;
        let voxels = match element {
            Element::U8 => Voxels::U8(chunks.read(progress)?),
            Element::I8 => Voxels::I8(chunks.read(progress)?),
            Element::U16 => Voxels::U16(chunks.read(progress)?),
            Element::I16 => Voxels::I16(chunks.read(progress)?),
            Element::F32 => Voxels::F32(chunks.read(progress)?),
            Element::F16 => narrowed(&path, element, chunks.read::<f16>(progress)?)?,
            Element::U32 => narrowed(&path, element, chunks.read::<u32>(progress)?)?,
            Element::I32 => narrowed(&path, element, chunks.read::<i32>(progress)?)?,
            Element::U64 => narrowed(&path, element, chunks.read::<u64>(progress)?)?,
            Element::I64 => narrowed(&path, element, chunks.read::<i64>(progress)?)?,
            Element::F64 => narrowed(&path, element, chunks.read::<f64>(progress)?)?,
        };
        let [x, y, z] = DVec3::AXES;
        let step = self.step;
        let steps = [x * step.x, y * step.y, z * step.z];
        let world_from_ix =
            grid::placement(&path, "coordinateTransformations", steps, self.origin)?;
        grid::volume(&path, voxels, self.grid, world_from_ix, Rescale::default())
    }

    /// The index on each axis that is none of space: of channel and time as asked for.
    fn fixed(&self, store: &Store<'_>, options: &ReadOptions<'_>) -> Result<Vec<u64>> {
        let mut fixed = vec![0; self.array.shape.len()];
        let asked = [
            (self.axes.channel, "channel", options.channel),
            (self.axes.time, "timestep", options.timestep),
        ];
        for (axis, key, asked) in asked {
            let count = match axis {
                Some(axis) => self.array.shape.get(axis).copied().unwrap_or(1),
                None => 1,
            };
            let index = u64::from(asked.unwrap_or(0));
            if index >= count {
                let what = format!("volume.{key} {index} of {count}; the first is 0");
                return Err(store.bad(&self.path, what));
            }
            if count > 1 && asked.is_none() {
                tracing::info!("{count} of {key}, the first is read; volume.{key} picks another");
            }
            if let Some(fixed) = axis.and_then(|axis| fixed.get_mut(axis)) {
                *fixed = index;
            }
        }
        Ok(fixed)
    }
}
