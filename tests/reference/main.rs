//! The reference renderer against closed forms, hand-computed sums and symmetries; and the scenes that it
//! is compared on.

#[path = "../common/scenes.rs"]
mod scenes;
#[path = "../common/transport_scenes.rs"]
mod transport_scenes;
#[path = "../common/z_test.rs"]
mod z_test;

mod fixtures;

mod classification;
mod directions;
mod field;
mod filters;
mod gradients;
mod isosurfaces;
mod light;
mod march;
mod mitsuba;
mod profiles;
mod projections;
mod scenes_are_fair;
mod transport;
