//! GPU benches.

fn main() {}
