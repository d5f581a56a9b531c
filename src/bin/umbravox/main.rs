//! The `umbravox` program.

fn main() {}
