//! What the bench compares pictures and light with.

use super::{FrameTime, PassStats, Session, light_volume};
use crate::error::Result;
use crate::renderer::Work;

impl Session {
    /// The device's limit: marches the same rays, but only samples one texture of the volume's format and size and looks the
    /// transfer function up; as many samples as a picture takes without skipping and early termination. The picture
    /// is lost.
    ///
    /// # Errors
    /// As [`Session::frame`].
    pub fn timed_bare_march(&mut self) -> Result<FrameTime> {
        self.timed(Work::Bare, false)
    }

    /// Traces one more direction of light, as [`Session::refine_light`] does; `None` when none is left.
    ///
    /// # Errors
    /// As [`Session::refine_light`].
    pub fn timed_light(&mut self) -> Result<Option<FrameTime>> {
        let (traced, rays) = self.renderer.loaded().light_progress();
        if traced == rays {
            return Ok(None);
        }
        self.timed(Work::LightOnly, false).map(Some)
    }

    /// The limit of a direction of light: for every sample of the light volume as many samples of the field as a ray has at the
    /// finest level, each one texture read and one look-up of the transfer function. `None` when ambient occlusion is off. The
    /// light starts again.
    ///
    /// # Errors
    /// As [`Session::frame`].
    pub fn timed_bare_light(&mut self) -> Result<Option<FrameTime>> {
        if self.light_rays() == 0 {
            return Ok(None);
        }
        self.restart_light();
        let time = self.timed(Work::BareLight, false)?;
        self.restart_light();
        Ok(Some(time))
    }

    /// Samples of the field that all directions of light take together. `None` when ambient occlusion is off, where levels of
    /// detail mix, and where a voxel's share may exceed what the light volume's half floats count, 2048. The light starts again.
    ///
    /// # Errors
    /// As [`Session::frame`].
    pub fn count_light_samples(&mut self) -> Result<Option<u64>> {
        let rays = self.light_rays();
        let most = match &self.settings().ambient_occlusion {
            Some(ao) => rays.saturating_mul(ao.samples_per_ray()),
            None => return Ok(None),
        };
        if most > 2048 || !self.renderer.loaded().residency().layout.is_grid() {
            return Ok(None);
        }
        self.restart_light();
        for _ in 0..rays {
            self.submit(Work::CountLight)?;
        }
        let atlas = self.read_back(&self.renderer.loaded().images().light, 8)?;
        let counted = light_volume::unpack(self.renderer.loaded(), bytemuck::cast_slice(&atlas))?;
        self.restart_light();
        let bias = self.renderer.loaded().light_bias();
        let voxels = counted.rgba.iter().filter(|voxel| voxel[3] > 0.0);
        Ok(Some(voxels.map(|v| (v[0] - bias).round() as u64).sum()))
    }

    fn restart_light(&mut self) {
        self.renderer.restart_light();
        self.times.restart_light();
    }

    /// Times on the device as in [`super::Stats::passes`]; reads nothing back.
    pub fn passes(&self) -> Vec<PassStats> {
        self.times.passes()
    }
}
