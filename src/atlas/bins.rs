//! Direction bins of the discrete ordinates (Max 1995, section VII D): the exterior faces of a block of n^3 cubes, 6 n^2 of them.

use glam::DVec3;

use crate::scene::PhaseFunction;

/// Places on an axis of a bin that its phase function is averaged over.
const PARTS: u32 = 4;

/// A bin: its direction and its solid angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Bin {
    /// Through the middle of its face.
    pub(crate) direction: DVec3,
    pub(crate) solid_angle: f64,
    face: u32,
    place: [u32; 2],
}

/// All bins of a sphere.
pub(crate) struct Bins {
    n: u32,
    bins: Vec<Bin>,
}

impl Bins {
    /// `count`: 6 n^2.
    pub(crate) fn new(count: u32) -> Self {
        let n = (count / 6).isqrt().max(1);
        let bins = (0..6)
            .flat_map(|face| (0..n * n).map(move |i| (face, [i % n, i / n])))
            .map(|(face, place)| Bin {
                direction: direction(face, place, n, [0.5; 2]),
                solid_angle: solid_angle(place, n),
                face,
                place,
            })
            .collect();
        Self { n, bins }
    }

    pub(crate) fn len(&self) -> u32 {
        self.bins.len() as u32
    }

    /// Directions and solid angles.
    pub(crate) fn texels(&self) -> Vec<[f32; 4]> {
        let texel = |bin: &Bin| bin.direction.extend(bin.solid_angle).as_vec4().to_array();
        self.bins.iter().map(texel).collect()
    }

    /// Phase function between bins, rows by outgoing, columns by incoming bin: averaged over both, and scaled so that what comes in
    /// goes out.
    pub(crate) fn phase_matrix(&self, phase: &PhaseFunction) -> Vec<f32> {
        let count = self.bins.len();
        let parts: Vec<Vec<DVec3>> = self.bins.iter().map(|bin| self.parts(bin)).collect();
        let mut matrix = vec![0.0f32; count * count];
        for incoming in 0..count {
            let mean = |outgoing: usize| {
                let pairs = parts[incoming]
                    .iter()
                    .flat_map(|a| parts[outgoing].iter().map(move |b| a.dot(*b)));
                let sum: f64 = pairs.map(|cos| phase.evaluate(cos.clamp(-1.0, 1.0))).sum();
                sum / f64::from(PARTS.pow(4))
            };
            let column: Vec<f64> = (0..count).map(mean).collect();
            let whole: f64 = column
                .iter()
                .zip(&self.bins)
                .map(|(p, bin)| p * bin.solid_angle)
                .sum();
            for (outgoing, p) in column.into_iter().enumerate() {
                matrix[outgoing * count + incoming] = (p / whole) as f32;
            }
        }
        matrix
    }

    fn parts(&self, bin: &Bin) -> Vec<DVec3> {
        let middle = |i: u32| (f64::from(i) + 0.5) / f64::from(PARTS);
        (0..PARTS * PARTS)
            .map(|i| {
                let within = [middle(i % PARTS), middle(i / PARTS)];
                direction(bin.face, bin.place, self.n, within)
            })
            .collect()
    }
}

/// From the middle of the block through a place of a bin's face; `within` from 0 to 1 on both axes.
fn direction(face: u32, place: [u32; 2], n: u32, within: [f64; 2]) -> DVec3 {
    let [u, v] = [0, 1].map(|i| 2.0 * (f64::from(place[i]) + within[i]) / f64::from(n) - 1.0);
    let side = if face.is_multiple_of(2) { 1.0 } else { -1.0 };
    let d = match face / 2 {
        0 => DVec3::new(side, u, v),
        1 => DVec3::new(v, side, u),
        _ => DVec3::new(u, v, side),
    };
    d.normalize()
}

/// Solid angle of a rectangle on a face at distance 1, by its corners.
fn solid_angle(place: [u32; 2], n: u32) -> f64 {
    let edge = |i: u32| 2.0 * f64::from(i) / f64::from(n) - 1.0;
    let corner = |x: f64, y: f64| (x * y / (1.0 + x * x + y * y).sqrt()).atan();
    let [x0, y0] = place.map(edge);
    let [x1, y1] = place.map(|i| edge(i + 1));
    corner(x1, y1) - corner(x0, y1) - corner(x1, y0) + corner(x0, y0)
}

#[cfg(test)]
mod tests {
    use super::Bins;
    use crate::scene::PhaseFunction;

    #[test]
    fn bins_fill_the_sphere() {
        for count in [24, 54, 96, 150, 216] {
            let bins = Bins::new(count);
            assert_eq!(bins.len(), count);
            let whole: f64 = bins.bins.iter().map(|b| b.solid_angle).sum();
            assert!(
                (whole - 4.0 * std::f64::consts::PI).abs() < 1e-12,
                "{count}: {whole}"
            );
            let mean: glam::DVec3 = bins.bins.iter().map(|b| b.direction * b.solid_angle).sum();
            assert!(mean.length() < 1e-12, "{count}: {mean}");
        }
    }

    #[test]
    fn what_comes_in_goes_out() {
        let bins = Bins::new(96);
        for phase in [
            PhaseFunction::Isotropic,
            PhaseFunction::HenyeyGreenstein { g: 0.8 },
            PhaseFunction::LambertSphere,
        ] {
            let matrix = bins.phase_matrix(&phase);
            for incoming in 0..96 {
                let out: f64 = (0..96)
                    .map(|o| f64::from(matrix[o * 96 + incoming]) * bins.bins[o].solid_angle)
                    .sum();
                assert!((out - 1.0).abs() < 1e-6, "{phase:?}: {out}");
            }
        }
    }
}
