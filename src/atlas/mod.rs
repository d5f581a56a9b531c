//! The volume on the device: transfer-function table, resident bricks, skip cells, light, and what has to be uploaded when.
//!
//! Three things change at different times, and each has a type: [`Store`] with the data, [`Residency`] with
//! the choice of levels, [`Visibility`] with the transfer function. [`Images`] holds their device side.

mod bins;
mod colors;
mod gradients;
mod images;
mod labels;
mod light_work;
mod lit_voxels;
mod majorant;
mod medium;
mod packed_cells;
mod pages;
mod preintegration;
mod residency;
mod scatter;
mod shown;
mod transfer_table;
mod upload;
mod visibility;

pub(crate) use bins::Bins;
pub(crate) use colors::{COLOR_TEXEL_BYTES, ColorAtlas};
pub(crate) use gradients::{
    CHUNK as GRADIENT_CHUNK, GradientStore, GradientTexels, GradientVolume,
};
pub(crate) use images::{Images, LIGHT_TEXEL_BYTES, LightLists, TableImages};
pub(crate) use labels::LabelImages;
pub(crate) use light_work::LightWork;
pub(crate) use lit_voxels::GROUP;
pub(crate) use majorant::Majorants;
pub(crate) use medium::{LightGrid, MediumExtents, MediumImages, MediumTexels};
pub(crate) use packed_cells::{PackedCells, Packing};
pub(crate) use pages::Pages;
pub(crate) use preintegration::{Preintegration, ROWS as INTEGRAL_ROWS};
pub(crate) use residency::{Residency, Store};
pub(crate) use scatter::{ScatterImages, Solver};
pub(crate) use shown::Shown;
pub(crate) use transfer_table::{SampleLengths, SampleScale, TransferTable};
pub(crate) use upload::{UploadResources, Uploads};
pub(crate) use visibility::{Visibility, VisibilityRequest};
