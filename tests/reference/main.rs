//! The reference renderer against closed forms, hand-computed sums and symmetries; and the scenes that it
//! is compared on.

#[path = "../common/scenes.rs"]
mod scenes;

mod fixtures;

mod classification;
mod directions;
mod field;
mod filters;
mod gradients;
mod isosurfaces;
mod light;
mod march;
mod profiles;
mod projections;
mod scenes_are_fair;
