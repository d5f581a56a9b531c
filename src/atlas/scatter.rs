//! The device side of scattered light: what its solvers work on.

use std::sync::Arc;

use ash::vk;

use super::{Bins, LightGrid};
use crate::error::{Error, Result};
use crate::gpu::memory::MemoryLocation;
use crate::gpu::{Access, Buffer, Context, CopyBox, Filter, Image, ImageInfo, Recorder, Sampler};
use crate::scene::PhaseFunction;

/// Tiles of the source of diffusion: power and its first moment along three axes.
const DIFFUSION_TILES: u32 = 4;
/// Tiles of the zonal method: power and what comes from around; fluence before and after.
const ZONAL_TILES: u32 = 2;

/// How scattered light is solved for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Solver {
    /// Discrete ordinates with as many direction bins.
    Ordinates(u32),
    Diffusion,
    Zonal,
}

/// Images of one solver.
pub(crate) struct ScatterImages {
    pub(crate) grid: LightGrid,
    pub(crate) solver: Solver,
    /// Scattering and extinction, averaged over cells.
    pub(crate) medium: Image,
    /// Radiance emitted per mm.
    pub(crate) emission: Image,
    /// By direction bin; one texel without.
    pub(crate) intensity: Image,
    /// By direction bin, or in the tiles of the solver.
    pub(crate) source: Image,
    pub(crate) fluence: Image,
    /// Directions and solid angles.
    pub(crate) bins: Image,
    /// Phase function between bins.
    pub(crate) phase_matrix: Image,
    /// By iteration: largest change, largest fluence.
    pub(crate) residual: Buffer,
    pub(crate) nearest: Sampler,
    iterations: u32,
    stale: bool,
}

impl ScatterImages {
    /// # Errors
    /// [`Error::OutOfMemory`], [`Error::Unsupported`] for extents beyond the device's limits.
    pub(crate) fn new(
        context: &Arc<Context>,
        name: &str,
        grid: LightGrid,
        solver: Solver,
        isotropic: bool,
        iterations: u32,
    ) -> Result<Self> {
        let max = context.capabilities().max_extent_3d;
        let volume = |part: &str, extent: [u32; 3]| {
            let name = format!("{name}.scatter_{part}");
            if extent.iter().any(|&n| n > max) {
                return Err(Error::Unsupported {
                    device: context.capabilities().name.clone(),
                    need: format!("a 3D image of {extent:?} texels for {name}"),
                    have: format!(
                        "at most {max} on an axis; give a smaller lighting.scattering.resolution"
                    ),
                });
            }
            image(context, &name, extent, true)
        };
        let [x, y, z] = grid.points;
        let bins = match solver {
            Solver::Ordinates(bins) => bins,
            Solver::Diffusion | Solver::Zonal => Self::BINS_AROUND,
        };
        let columns = Self::columns_of(bins);
        let tiled = [x * columns, y * bins.div_ceil(columns), z];
        let (intensity, source, fluence) = match solver {
            Solver::Ordinates(_) if isotropic => (tiled, grid.points, grid.points),
            Solver::Ordinates(_) => (tiled, tiled, grid.points),
            Solver::Diffusion => ([1; 3], [x * DIFFUSION_TILES, y, z], grid.points),
            Solver::Zonal => ([1; 3], [x * DIFFUSION_TILES, y, z], [x * ZONAL_TILES, y, z]),
        };
        let flat = |part: &str, extent: [u32; 2]| {
            let name = format!("{name}.scatter_{part}");
            image(context, &name, [extent[0], extent[1], 1], false)
        };
        let matrix = match solver {
            Solver::Ordinates(bins) if !isotropic => [bins; 2],
            _ => [1; 2],
        };
        Ok(Self {
            grid,
            solver,
            medium: volume("medium", grid.points)?,
            emission: volume("emission", grid.points)?,
            intensity: volume("intensity", intensity)?,
            source: volume("source", source)?,
            fluence: volume("fluence", fluence)?,
            bins: flat("bins", [bins, 1])?,
            phase_matrix: flat("phase_matrix", matrix)?,
            residual: residual(context, name, iterations)?,
            nearest: Sampler::new(context, &format!("{name}.scatter.nearest"), Filter::Nearest)?,
            iterations,
            stale: true,
        })
    }

    /// Directions by which the zonal method looks around.
    const BINS_AROUND: u32 = 96;

    fn columns_of(bins: u32) -> u32 {
        f64::from(bins).sqrt().ceil() as u32
    }

    /// Directions of the bins.
    pub(crate) fn bins(&self) -> u32 {
        self.bins.extent()[0]
    }

    /// Tiles of bins side by side.
    pub(crate) fn columns(&self) -> u32 {
        Self::columns_of(self.bins())
    }

    /// Largest change of an iteration as a share of the largest fluence, once the device has gone on to the next one.
    ///
    /// # Errors
    /// [`Error::Vulkan`] when the memory cannot be read.
    pub(crate) fn residual(&self, iteration: u32) -> Result<Option<f64>> {
        if iteration >= self.iterations {
            return Ok(None);
        }
        // The device may be writing later words at this moment.
        let word = |i: u32| self.residual.read_word(i as usize).map(f32::from_bits);
        let (change, largest) = (word(2 * iteration)?, word(2 * iteration + 1)?);
        let next = word(2 * iteration + 3)? > 0.0;
        Ok((next && largest > 0.0).then(|| f64::from(change) / f64::from(largest)))
    }

    /// What the solver starts from is gone; see [`Image::forget`].
    ///
    /// # Errors
    /// [`Error::OutOfMemory`].
    pub(crate) fn restart(&mut self, context: &Arc<Context>, name: &str) -> Result<()> {
        self.residual = residual(context, name, self.iterations)?;
        Ok(())
    }

    /// See [`Image::forget`].
    pub(crate) fn forget(&mut self) {
        for image in [
            &self.medium,
            &self.emission,
            &self.intensity,
            &self.source,
            &self.fluence,
            &self.bins,
            &self.phase_matrix,
        ] {
            image.forget();
        }
        self.stale = true;
    }

    /// Uploads bins and phase matrix where they are missing.
    pub(crate) fn record(
        &mut self,
        context: &Arc<Context>,
        recorder: &mut Recorder<'_>,
        phase: &PhaseFunction,
    ) -> Result<()> {
        if !std::mem::take(&mut self.stale) {
            return Ok(());
        }
        let bins = Bins::new(self.bins());
        let matrix = if self.phase_matrix.extent()[0] == bins.len() {
            let matrix = bins.phase_matrix(phase);
            matrix.into_iter().map(|p| [p, 0.0, 0.0, 0.0]).collect()
        } else {
            vec![[0.0f32; 4]]
        };
        for (texels, to) in [(bins.texels(), &self.bins), (matrix, &self.phase_matrix)] {
            let bytes = bytemuck::cast_slice(&texels);
            let usage = vk::BufferUsageFlags::TRANSFER_SRC;
            let from = Buffer::upload(context, "umbravox.upload.bins", bytes, usage)?;
            recorder.upload(&from, to, &[CopyBox::packed(0, [0; 3], to.extent())]);
            recorder.use_image(to, Access::SampledRead);
        }
        recorder.flush();
        Ok(())
    }
}

fn image(
    context: &Arc<Context>,
    name: &str,
    extent: [u32; 3],
    three_dimensional: bool,
) -> Result<Image> {
    let usage = if three_dimensional {
        vk::ImageUsageFlags::STORAGE
    } else {
        vk::ImageUsageFlags::TRANSFER_DST
    };
    Image::new(
        context,
        &ImageInfo {
            name,
            extent,
            format: vk::Format::R32G32B32A32_SFLOAT,
            three_dimensional,
            usage: vk::ImageUsageFlags::SAMPLED | usage,
        },
    )
}

/// Zeros for every iteration, and one that never comes.
fn residual(context: &Arc<Context>, name: &str, iterations: u32) -> Result<Buffer> {
    let mut buffer = Buffer::new(
        context,
        &format!("{name}.scatter_residual"),
        u64::from(iterations + 2) * 8,
        vk::BufferUsageFlags::STORAGE_BUFFER,
        MemoryLocation::Readback,
    )?;
    buffer.mapped_mut()?.fill(0);
    Ok(buffer)
}
