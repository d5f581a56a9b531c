//! The reference renderer against closed forms, hand-computed sums and symmetries; and the scenes that it
//! is compared on.

#[path = "../common/scenes.rs"]
mod scenes;

mod fixtures;

mod directions;
mod field;
mod gradients;
mod light;
mod march;
mod profiles;
mod scenes_are_fair;
