//! Gradient noise (Perlin 2002, "Improving Noise") and its sums over octaves.

use glam::DVec3;

use crate::scene::random::Random;

/// Noise with a permutation of its own for every seed.
pub(super) struct Noise {
    permutation: [u8; 256],
}

impl Noise {
    pub(super) fn new(seed: u32) -> Self {
        let mut random = Random::new(seed.into());
        let mut permutation: [u8; 256] = std::array::from_fn(|i| i as u8);
        for i in (1..permutation.len()).rev() {
            permutation.swap(i, (random.share() * (i + 1) as f64) as usize);
        }
        Self { permutation }
    }

    /// Noise in `[-1,1]`, 0 at whole coordinates, twice continuously differentiable, period 256 on each axis.
    pub(super) fn at(&self, p: DVec3) -> f64 {
        let cell = p.floor();
        let within = p - cell;
        // The quintic fade, 6t^5 - 15t^4 + 10t^3.
        let fade = within.powf(3.0) * (within * (within * 6.0 - 15.0) + 10.0);
        let corner = |x: i64, y: i64, z: i64| {
            let [i, j, k] = [
                (cell.x as i64) + x,
                (cell.y as i64) + y,
                (cell.z as i64) + z,
            ];
            let offset = within - DVec3::new(x as f64, y as f64, z as f64);
            gradient(self.hash(k, self.hash(j, self.hash(i, 0))), offset)
        };
        let mix = |a: f64, b: f64, t: f64| a + (b - a) * t;
        let edge = |y: i64, z: i64| mix(corner(0, y, z), corner(1, y, z), fade.x);
        let face = |z: i64| mix(edge(0, z), edge(1, z), fade.y);
        mix(face(0), face(1), fade.z)
    }

    /// `sum_i 2^-i noise(2^i p)` over octaves, in shares of `sum_i 2^-i`: in `[-1,1]`.
    pub(super) fn fractal(&self, p: DVec3, octaves: u32) -> f64 {
        let mut sum = 0.0;
        let mut weights = 0.0;
        for octave in 0..octaves {
            let scale = f64::from(octave).exp2();
            // Noise is 0 at whole coordinates: without an offset all octaves would vanish at the same places.
            let offset = DVec3::new(0.37, 0.71, 0.13) * f64::from(octave);
            sum += self.at(p * scale + offset) / scale;
            weights += 1.0 / scale;
        }
        if weights > 0.0 { sum / weights } else { 0.0 }
    }

    fn hash(&self, coordinate: i64, before: u8) -> u8 {
        let at = (coordinate + i64::from(before)).rem_euclid(256);
        self.permutation[at as usize]
    }
}

/// Product with the gradient that a hash picks: to one of the middles of a cube's edges.
fn gradient(hash: u8, offset: DVec3) -> f64 {
    let DVec3 { x, y, z } = offset;
    let [u, v] = match hash % 12 {
        0..4 => [x, y],
        4..8 => [x, z],
        _ => [y, z],
    };
    let sign = |bit: u8| if hash >> bit & 1 == 0 { 1.0 } else { -1.0 };
    sign(0) * u + sign(1) * v
}
