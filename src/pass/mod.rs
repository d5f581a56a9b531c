//! The compute passes. Each file is one: its pipeline variants, what it binds, what it dispatches.

pub(crate) mod bare;
pub(crate) mod bare_light;
pub(crate) mod beams;
pub(crate) mod gradients;
pub(crate) mod light;
pub(crate) mod pack_cells;
pub(crate) mod picture;
pub(crate) mod preintegrate;
pub(crate) mod scatter;
pub(crate) mod shadow;

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::atlas::{GradientVolume, Images, LabelImages};
use crate::error::Result;
use crate::gpu::{Access, Bound, Context, Image, Pipeline, Recorder, Sampler, TexelBuffer};
use crate::scene::{Classification, Gradient, Interpolation};
use crate::shader::PassInterface;

/// Specialization constants: id and value.
type Constants = Vec<(u32, u32)>;

/// Pipelines of one pass by specialization, compiled when first used.
#[derive(Default)]
pub(crate) struct Variants {
    /// By module and (id, value) pairs.
    pipelines: BTreeMap<(&'static str, Constants), Pipeline>,
}

impl Variants {
    /// The pipeline of `interface` specialized by (id, value) pairs and what the device decides; ids it does not have are left out.
    pub(crate) fn get(
        &mut self,
        context: &Arc<Context>,
        interface: &'static PassInterface,
        constants: Constants,
    ) -> Result<&Pipeline> {
        use crate::shader::generated::{SPEC_LOADS, SPEC_RUNS};
        use std::collections::btree_map::Entry;
        let mut constants = constants;
        let capabilities = context.capabilities();
        constants.extend([
            (SPEC_RUNS, capabilities.dispatch_runs),
            (SPEC_LOADS, capabilities.loads_texels.into()),
        ]);
        constants.retain(|(id, _)| interface.spec_ids.contains(id));
        match self.pipelines.entry((interface.module.name, constants)) {
            Entry::Occupied(there) => Ok(there.into_mut()),
            Entry::Vacant(free) => {
                let pipeline = Pipeline::new(context, interface, &free.key().1)?;
                Ok(free.insert(pipeline))
            }
        }
    }
}

/// How the field is reconstructed, shared by all passes that sample it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Reconstruction {
    pub(crate) interpolation: Interpolation,
    /// The texture unit cannot filter the voxel format.
    pub(crate) manual: bool,
    /// Bytes of the samples whose packed corners are read instead of filtering; 0 for none.
    pub(crate) packed_cells: u32,
    pub(crate) inter_block: bool,
    pub(crate) skipping: bool,
    pub(crate) emission: bool,
    /// Every brick is on the device, at the finest level and in the grid layout.
    pub(crate) uniform_grid: bool,
    /// The transfer-function table has bins whose opacity is computed, not interpolated.
    pub(crate) exact_bins: bool,
    /// Labels hide or colour samples.
    pub(crate) labels: bool,
}

impl Reconstruction {
    /// Whether the march can take two samples at once, of packed corners. Segments that are integrated between their ends may lead from
    /// brick to brick, and are taken one by one where levels mix.
    pub(crate) fn pairs(self, classification: Classification) -> bool {
        let classifies = match classification {
            Classification::Post => true,
            Classification::Preintegrated => self.uniform_grid,
            Classification::Pre => false,
        };
        classifies && self.packed_cells > 0 && self.interpolation == Interpolation::Linear
    }

    /// Specialization constants, the same ids in every pass.
    pub(crate) fn constants(self) -> Constants {
        use crate::shader::generated::{
            SPEC_BLOCKS_APART, SPEC_EMISSION, SPEC_EXACT_BINS, SPEC_INTERPOLATION, SPEC_LABELS,
            SPEC_MANUAL_FILTER, SPEC_PACKED_CELLS, SPEC_SKIPPING, SPEC_UNIFORM_GRID,
        };
        vec![
            (
                SPEC_INTERPOLATION,
                match self.interpolation {
                    Interpolation::Nearest => 0,
                    Interpolation::Linear => 1,
                    Interpolation::Bspline => 2,
                    Interpolation::CatmullRom => 3,
                },
            ),
            (SPEC_MANUAL_FILTER, self.manual.into()),
            (SPEC_PACKED_CELLS, self.packed_cells),
            (SPEC_BLOCKS_APART, (!self.inter_block).into()),
            (SPEC_SKIPPING, self.skipping.into()),
            (SPEC_EMISSION, self.emission.into()),
            (SPEC_UNIFORM_GRID, self.uniform_grid.into()),
            (SPEC_EXACT_BINS, self.exact_bins.into()),
            (SPEC_LABELS, self.labels.into()),
        ]
    }
}

/// How the shaders call an estimator.
fn gradient_constant(gradient: Gradient) -> u32 {
    match gradient {
        Gradient::CentralDifferences => 0,
        Gradient::FourPoint => 1,
        Gradient::Regression => 2,
        Gradient::Sobel => 3,
        Gradient::Bspline => 4,
        Gradient::CatmullRom => 5,
    }
}

/// An image with a sampler, in the layout for sampling alone.
fn sampled<'a>(image: &'a Image, sampler: &'a Sampler) -> Bound<'a> {
    Bound::Sampled {
        image,
        sampler,
        general: false,
    }
}

/// An image that shaders fetch from or load, as the device does faster: it stays in `GENERAL`. `bindings`: the sampled one, and that
/// of a storage image.
fn use_texels<'a>(
    recorder: &mut Recorder<'_>,
    bindings: [u32; 2],
    image: &'a Image,
    sampler: &'a Sampler,
) -> [(u32, Bound<'a>); 2] {
    recorder.use_image(image, Access::SampledGeneral);
    let fetched = Bound::Sampled {
        image,
        sampler,
        general: true,
    };
    [
        (bindings[0], fetched),
        (bindings[1], Bound::StorageImage(image)),
    ]
}

/// The transfer function's table.
fn use_transfer<'a>(recorder: &mut Recorder<'_>, images: &'a Images) -> [(u32, Bound<'a>); 2] {
    use crate::shader::generated::{BINDING_TRANSFER, BINDING_TRANSFER_LOADS};
    let bindings = [BINDING_TRANSFER, BINDING_TRANSFER_LOADS];
    use_texels(recorder, bindings, &images.transfer, &images.nearest)
}

/// Where bricks lie.
fn use_index<'a>(recorder: &mut Recorder<'_>, images: &'a Images) -> [(u32, Bound<'a>); 2] {
    use crate::shader::generated::{BINDING_INDEX, BINDING_INDEX_LOADS};
    let bindings = [BINDING_INDEX, BINDING_INDEX_LOADS];
    use_texels(recorder, bindings, &images.index, &images.nearest)
}

/// A texel buffer that shaders load from.
fn use_texel_buffer<'a>(recorder: &mut Recorder<'_>, texels: &'a TexelBuffer) -> Bound<'a> {
    recorder.use_buffer(texels.buffer(), TexelBuffer::LOADED);
    Bound::Texels(texels)
}

/// The packed corners of voxel cells; without any a texel of the same kind stands in, which nothing reads.
fn use_packed_cells<'a>(recorder: &mut Recorder<'_>, images: &'a Images) -> (u32, Bound<'a>) {
    let cells = images
        .packed_cells
        .as_ref()
        .map_or(&images.no_texels.cells, |c| &c.texels);
    let binding = crate::shader::generated::BINDING_PACKED_CELLS;
    (binding, use_texel_buffer(recorder, cells))
}

/// What every pass that samples and classifies the field reads: asks for the barriers and gives the bindings.
fn use_field<'a>(recorder: &mut Recorder<'_>, images: &'a Images) -> Vec<(u32, Bound<'a>)> {
    use crate::shader::generated::{BINDING_ATLAS, BINDING_SKIP, BINDING_SKIP_LOADS};
    let mut bound = vec![use_packed_cells(recorder, images)];
    recorder.use_image(&images.atlas, Access::SampledRead);
    let atlas = sampled(&images.atlas, images.atlas_sampler());
    bound.push((BINDING_ATLAS, atlas));
    bound.extend(use_index(recorder, images));
    let bindings = [BINDING_SKIP, BINDING_SKIP_LOADS];
    bound.extend(use_texels(
        recorder,
        bindings,
        &images.skip,
        &images.nearest,
    ));
    bound.extend(use_transfer(recorder, images));
    bound
}

/// The volume of gradients, for each kind of its texels; where it is of another kind, or there is none, others of the same kind stand
/// in, which nothing reads.
fn use_gradients<'a>(
    recorder: &mut Recorder<'_>,
    images: &'a Images,
    gradients: Option<&'a GradientVolume>,
    unused: (&'a Image, &'a Sampler),
) -> [(u32, Bound<'a>); 4] {
    use crate::shader::generated::BINDING_GRADIENTS;
    let filtered = gradients
        .and_then(GradientVolume::image)
        .unwrap_or(unused.0);
    recorder.use_image(filtered, Access::SampledRead);
    let [a, b, c] = GradientVolume::texel_buffers(gradients, &images.no_texels)
        .map(|(binding, texels)| (binding, use_texel_buffer(recorder, texels)));
    [(BINDING_GRADIENTS, sampled(filtered, unused.1)), a, b, c]
}

/// What a pass that looks labels up reads; without labels images of the same kinds stand in, which it does not read.
fn use_labels<'a>(
    recorder: &mut Recorder<'_>,
    images: &'a Images,
    labels: Option<&'a LabelImages>,
) -> [(u32, Bound<'a>); 2] {
    use crate::shader::generated::{BINDING_LABEL_TABLE, BINDING_LABELS};
    let (map, table, access) = match labels {
        Some(labels) => (&labels.map, &labels.table, Access::SampledRead),
        None => (&images.skip, &images.transfer, Access::SampledGeneral),
    };
    [(BINDING_LABELS, map), (BINDING_LABEL_TABLE, table)].map(|(binding, image)| {
        recorder.use_image(image, access);
        let bound = Bound::Sampled {
            image,
            sampler: &images.nearest,
            general: access == Access::SampledGeneral,
        };
        (binding, bound)
    })
}

/// Pixels on an edge of a tile, at most.
pub(crate) const LARGEST_TILE: u32 = 8192;

/// Pixels of a picture from a first one up to an end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Rectangle {
    pub(crate) first: [u32; 2],
    pub(crate) end: [u32; 2],
}

impl Rectangle {
    /// A whole picture.
    pub(crate) fn of_size(size: [u32; 2]) -> Self {
        Self {
            first: [0; 2],
            end: size,
        }
    }

    /// Consecutive pieces, at most `tile` on an edge.
    pub(crate) fn tiles(self, tile: u32) -> impl Iterator<Item = Self> {
        let Self { first, end } = self;
        let axis = move |axis: usize| (first[axis]..end[axis]).step_by(tile as usize);
        axis(1).flat_map(move |y| {
            axis(0).map(move |x| Self {
                first: [x, y],
                end: [(x + tile).min(end[0]), (y + tile).min(end[1])],
            })
        })
    }

    /// Workgroups of 8 x 8 that cover it.
    pub(crate) fn groups(self) -> [u32; 3] {
        let Self { first, end } = self;
        let [x, y] = [0, 1].map(|axis| (end[axis] - first[axis]).div_ceil(8));
        [x, y, 1]
    }
}
