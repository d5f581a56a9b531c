//! The volume of gradients: estimates at voxels, which texture units interpolate, or shaders where the device is a processor.
//!
//! One read in place of six and more for each shaded sample. It exists where the atlas is the volume itself and the memory budget has
//! room for it; its values are computed on the device, and only around what can be seen.

use std::sync::Arc;

use ash::vk;

use super::images::NoTexels;
use super::pages::Pages;
use super::residency::{Residency, Store};
use super::visibility::Visibility;
use crate::error::Result;
use crate::gpu::{Context, Image, ImageInfo, TexelBuffer};
use crate::scene::Gradient;
use crate::shader::generated::{
    BINDING_GRADIENTS_HALVES, BINDING_GRADIENTS_IN_FOURS, BINDING_GRADIENTS_TEN_BITS,
};
use crate::volume::VoxelType;
use crate::volume::cells::SKIP_CELLS;

/// Edge of what is computed together, voxels; the shader's `CHUNK`.
pub(crate) const CHUNK: u32 = 16;

/// What texels of gradients are, and who interpolates between them: the shaders' `STORED_GRADIENTS`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum GradientTexels {
    /// Halves, the texture unit.
    Filtered = 1,
    /// Ten bits a component in a word, the shader.
    TenBits = 2,
    /// Halves, the shader.
    Halves = 3,
    /// Ten bits a component, four in a texel: a third more, in half as many loads.
    InFours = 4,
}

/// Voxels from one texel of fours to the next, which share one; the shaders' `FOURS_APART`.
const FOURS_APART: u32 = 3;
/// Slices of which the shader finds the texel (`third_of`).
const FOURS_MOST: u32 = 32768;

impl GradientTexels {
    pub(crate) fn format(self) -> vk::Format {
        match self {
            Self::TenBits => vk::Format::R32_UINT,
            Self::InFours => vk::Format::R32G32B32A32_UINT,
            Self::Filtered | Self::Halves => vk::Format::R16G16B16A16_SFLOAT,
        }
    }

    /// Whether shaders load texels and interpolate, not the texture unit.
    pub(crate) fn are_loaded(self) -> bool {
        self != Self::Filtered
    }

    fn bytes(self) -> u32 {
        match self {
            Self::TenBits => 4,
            Self::Filtered | Self::Halves => 8,
            Self::InFours => 16,
        }
    }

    /// Of what shaders interpolate, in the shapes that they expect (gradient_pages.glsl).
    fn pages(self, [x, y, z]: [u32; 3]) -> Option<Pages> {
        let (extent, shape) = match self {
            Self::Filtered => return None,
            Self::TenBits => ([x, y, z], [8, 8, 16]),
            Self::Halves => ([x, y, z], [8, 8, 8]),
            Self::InFours => ([x, y, z.div_ceil(FOURS_APART)], [8, 8, 4]),
        };
        Some(Pages::of(extent, shape, self.bytes()))
    }

    /// Whether shaders are to interpolate, which only pays where the device is a processor, and can load so many texels.
    fn load(self, context: &Context, extent: [u32; 3]) -> bool {
        let bytes = self.pages(extent).map_or(0, Pages::bytes);
        context.capabilities().loads_texels
            && bytes <= TexelBuffer::max_bytes(context, self.bytes())
    }
}

/// How texels stand for gradients.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Coding {
    texels: GradientTexels,
    /// Texture samples per index unit that a texel counts.
    unit: f32,
}

impl Coding {
    /// `None` where halves cannot hold what the volume's range makes of gradients. `extent`: of the volume of gradients.
    /// `affords`: whether there is room for so many bytes of fours instead of so many of words.
    fn of(
        context: &Context,
        store: &Store,
        extent: [u32; 3],
        estimator: Gradient,
        affords: impl FnOnce(u64, u64) -> bool,
    ) -> Option<Self> {
        use GradientTexels::{Filtered, Halves, InFours, TenBits};
        let voxels = store.volume.voxels().voxel_type();
        let eight_bits = matches!(voxels, VoxelType::U8 | VoxelType::I8);
        let central = estimator == Gradient::CentralDifferences;
        let exact = eight_bits && central;
        let [fours, words] =
            [InFours, TenBits].map(|texels| texels.pages(extent).map_or(0, Pages::bytes));
        let in_fours = exact
            && extent[2] <= FOURS_MOST
            && InFours.load(context, extent)
            && affords(fours, words);
        if exact && (in_fours || TenBits.load(context, extent)) {
            // Differences of two voxels are whole numbers of halves of a step of theirs, at most 510: all of them are exact.
            return Some(Self {
                texels: if in_fours { InFours } else { TenBits },
                unit: 1.0 / 510.0,
            });
        }
        // Numbers up to 1024 and a little, so that what is thousands of times smaller keeps its digits.
        let range = match voxels {
            VoxelType::F32 => {
                let [low, high] = store.volume.stored_range();
                (high - low) as f32
            }
            _ => 1.0,
        };
        let unit = if range == 0.0 { 1.0 } else { range / 1024.0 };
        let loaded = Halves.load(context, extent);
        unit.is_normal().then_some(Self {
            texels: if loaded { Halves } else { Filtered },
            unit,
        })
    }
}

/// Where the texels are.
pub(crate) enum GradientStore {
    /// For the texture unit.
    Image(Image),
    /// For shaders that interpolate.
    Pages(TexelBuffer, Pages),
}

/// The volume of gradients on the device.
pub(crate) struct GradientVolume {
    pub(crate) store: GradientStore,
    estimator: Gradient,
    coding: Coding,
    /// Chunks on x, y, z.
    counts: [u32; 3],
    /// Chunks that are computed, x fastest.
    done: Vec<bool>,
    cleared: bool,
    /// What can be seen has changed since chunks were last chosen.
    stale: bool,
}

impl GradientVolume {
    /// `None` where bricks are packed, the estimator looks further than between voxels, the values span too much or too little
    /// for halves, or the budget, which the texels of the atlas share, has no room. `prefers`: whether so many bytes of texels that are
    /// read faster are worth more than what so many others leave room for.
    ///
    /// # Errors
    /// [`crate::Error::OutOfMemory`].
    #[expect(
        clippy::too_many_arguments,
        reason = "a part of loading, with what loading knows"
    )]
    pub(crate) fn new(
        context: &Arc<Context>,
        name: &str,
        store: &Store,
        residency: &Residency,
        estimator: Gradient,
        other_texel_bytes: u32,
        budget_bytes: u64,
        prefers: impl FnOnce(u64, u64) -> bool,
    ) -> Result<Option<Self>> {
        if !residency.layout.is_grid() || estimator.is_cubic() {
            return Ok(None);
        }
        let extent = residency.layout.extent();
        let voxel_bytes = store.volume.voxels().voxel_type().bytes() as u64;
        let texels = residency.layout.texels();
        let beside = texels.saturating_mul(voxel_bytes + u64::from(other_texel_bytes));
        let affords = |fours: u64, words: u64| {
            beside.saturating_add(fours) <= budget_bytes && prefers(fours, words)
        };
        let Some(coding) = Coding::of(context, store, extent, estimator, affords) else {
            return Ok(None);
        };
        let format = coding.texels.format();
        let pages = coding.texels.pages(extent);
        let texel_bytes = coding.texels.bytes().into();
        let bytes = pages.map_or_else(|| texels.saturating_mul(texel_bytes), Pages::bytes);
        if beside.saturating_add(bytes) > budget_bytes {
            return Ok(None);
        }
        let name = format!("{name}.gradients");
        let gradients = match pages {
            Some(pages) => {
                let texels = TexelBuffer::new(context, &name, format, pages.bytes())?;
                GradientStore::Pages(texels, pages)
            }
            None => GradientStore::Image(Image::new(
                context,
                &ImageInfo {
                    name: &name,
                    extent,
                    format,
                    three_dimensional: true,
                    usage: vk::ImageUsageFlags::SAMPLED
                        | vk::ImageUsageFlags::STORAGE
                        | vk::ImageUsageFlags::TRANSFER_DST,
                },
            )?),
        };
        let counts = store.grid().size().map(|n| n.div_ceil(CHUNK));
        Ok(Some(Self {
            store: gradients,
            estimator,
            coding,
            counts,
            done: vec![false; counts.iter().product::<u32>() as usize],
            cleared: false,
            stale: true,
        }))
    }

    pub(crate) fn estimator(&self) -> Gradient {
        self.estimator
    }

    /// Texture samples per index unit that a texel counts.
    pub(crate) fn unit(&self) -> f32 {
        self.coding.unit
    }

    pub(crate) fn texels(&self) -> GradientTexels {
        self.coding.texels
    }

    /// Other places may be seen now.
    pub(crate) fn look_again(&mut self) {
        self.stale = true;
    }

    /// What the texture unit filters, if it does.
    pub(crate) fn image(&self) -> Option<&Image> {
        match &self.store {
            GradientStore::Image(image) => Some(image),
            GradientStore::Pages(..) => None,
        }
    }

    /// What shaders load from, each kind of texels for its binding; those of `none` stand in.
    pub(crate) fn texel_buffers<'a>(
        gradients: Option<&'a Self>,
        none: &'a NoTexels,
    ) -> [(u32, &'a TexelBuffer); 3] {
        [
            (
                BINDING_GRADIENTS_TEN_BITS,
                GradientTexels::TenBits,
                &none.ten_bits,
            ),
            (
                BINDING_GRADIENTS_IN_FOURS,
                GradientTexels::InFours,
                &none.in_fours,
            ),
            (
                BINDING_GRADIENTS_HALVES,
                GradientTexels::Halves,
                &none.halves,
            ),
        ]
        .map(|(binding, kind, none)| {
            let texels = gradients.and_then(|gradients| match &gradients.store {
                GradientStore::Pages(texels, _) if gradients.texels() == kind => Some(texels),
                _ => None,
            });
            (binding, texels.unwrap_or(none))
        })
    }

    /// Bytes of device memory.
    pub(crate) fn bytes(&self) -> u64 {
        match &self.store {
            GradientStore::Image(image) => image.bytes(),
            GradientStore::Pages(texels, _) => texels.buffer().bytes(),
        }
    }

    /// What shaders load from.
    pub(crate) fn pages(&self) -> Option<Pages> {
        match self.store {
            GradientStore::Image(_) => None,
            GradientStore::Pages(_, pages) => Some(pages),
        }
    }

    /// See [`Image::forget`]. Everything is computed again.
    pub(crate) fn forget(&mut self) {
        match &self.store {
            GradientStore::Image(image) => image.forget(),
            GradientStore::Pages(texels, _) => texels.buffer().forget(),
        }
        self.done.fill(false);
        self.cleared = false;
        self.stale = true;
    }

    /// True once: interpolation gives weight 0 to texels that nothing was written to, which only a number makes nothing.
    pub(crate) fn is_first_use(&mut self) -> bool {
        !std::mem::replace(&mut self.cleared, true)
    }

    /// Chunks that are needed for the first time, for samples at most `reach` voxels from what shows something; they count as computed
    /// from now on.
    pub(crate) fn next_chunks(
        &mut self,
        residency: &Residency,
        visibility: &Visibility,
        reach: [u32; 3],
    ) -> Vec<[i32; 4]> {
        if !std::mem::take(&mut self.stale) {
            return Vec::new();
        }
        let [width, height, _] = residency.cells.counts().map(|n| n as usize);
        let counts = self.counts;
        let mut chunks = Vec::new();
        // A texel of fours belongs to the chunk where it begins.
        let begins_before = match self.texels() {
            GradientTexels::InFours => FOURS_APART - 1,
            _ => 0,
        };
        let visible = visibility.visible_cells();
        for cell in visible.map(|at| [at % width, at / width % height, at / (width * height)]) {
            let range = |axis: usize| {
                let first = cell[axis] as u32 * SKIP_CELLS;
                // One more, for what rounding takes for the next cell's.
                let reach = reach[axis] + 1;
                let last = (first + SKIP_CELLS + reach) / CHUNK;
                let before = reach + if axis == 2 { begins_before } else { 0 };
                first.saturating_sub(before) / CHUNK..=last.min(counts[axis] - 1)
            };
            for z in range(2) {
                for y in range(1) {
                    for x in range(0) {
                        let at = x + self.counts[0] * (y + self.counts[1] * z);
                        if !std::mem::replace(&mut self.done[at as usize], true) {
                            chunks.push([x as i32, y as i32, z as i32, 0]);
                        }
                    }
                }
            }
        }
        chunks
    }
}
