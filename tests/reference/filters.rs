//! Cubic kernels, and what reconstruction filters make of known fields.

use std::f64::consts::PI;

use glam::{DAffine3, DVec3};
use umbravox::reference::{CubicKernel, Field};
use umbravox::scene::Interpolation::{self, Bspline, CatmullRom, Linear, Nearest};
use umbravox::scene::{Gradient, directions};
use umbravox::volume::Volume;

use crate::fixtures::{assert_close, volume_of};

/// `sum_k w_k x_k^n` with `x_k` the voxels' positions relative to `t`.
fn moment(weights: [f64; 4], t: f64, n: i32) -> f64 {
    let offset = |k: usize| k as f64 - 1.0 - t;
    (0..4).map(|k| weights[k] * offset(k).powi(n)).sum()
}

/// Partition of unity; no shift; the derivative finds a slope and nothing else up to degree 2.
#[test]
fn moments_of_the_kernels() {
    for kernel in CubicKernel::ALL {
        for i in 0..=16 {
            let t = f64::from(i) / 16.0;
            let [w, d] = [kernel.weights(t), kernel.derivatives(t)];
            let second = match kernel {
                CubicKernel::Bspline => 1.0 / 3.0,
                CubicKernel::CatmullRom => 0.0,
            };
            for (n, expected) in [1.0, 0.0, second].into_iter().enumerate() {
                assert_close(moment(w, t, n as i32), expected, 1e-14);
            }
            for (n, expected) in [0.0, 1.0, 0.0].into_iter().enumerate() {
                assert_close(moment(d, t, n as i32), expected, 1e-14);
            }
        }
    }
}

/// The B-spline has two continuous derivatives, Catmull-Rom one; only that one goes through the voxels.
#[test]
fn kernels_continue_from_cell_to_cell() {
    for kernel in CubicKernel::ALL {
        for (end, start) in [
            (kernel.weights(1.0), kernel.weights(0.0)),
            (kernel.derivatives(1.0), kernel.derivatives(0.0)),
        ] {
            // Voxel k of a cell is voxel k-1 of the next; the voxels at the ends have left or not yet come.
            assert_close(end[0], 0.0, 1e-15);
            assert_close(start[3], 0.0, 1e-15);
            for k in 1..4 {
                assert_close(end[k], start[k - 1], 1e-15);
            }
        }
        let h = 1e-6;
        for t in [0.1, 0.5, 0.8] {
            for k in 0..4 {
                let slope = (kernel.weights(t + h)[k] - kernel.weights(t - h)[k]) / (2.0 * h);
                assert_close(kernel.derivatives(t)[k], slope, 1e-9);
            }
        }
    }
    assert_eq!(CubicKernel::CatmullRom.weights(0.0), [0.0, 1.0, 0.0, 0.0]);
    let [a, b, c] = [1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0];
    assert_eq!(CubicKernel::Bspline.weights(0.0), [a, b, c, 0.0]);
}

/// `x^2` comes back from the B-spline as `x^2 + 1/3`; Catmull-Rom reproduces it.
#[test]
fn polynomials_are_reproduced_to_each_filters_degree() {
    let at = DVec3::new(3.3, 4.0, 2.85);
    let linear = |p: DVec3| 2.0 * p.x - p.y + 0.5 * p.z + p.x * p.y * p.z;
    let [a, b] = [linear, |p: DVec3| p.x * p.x + p.y * p.z - p.z * p.z * 3.0].map(|f| {
        volume_of([8; 3], DAffine3::IDENTITY, |v| {
            f(DVec3::from_array(v.map(f64::from)))
        })
    });
    let value = |volume, filter| Field::new(volume).sample(at, filter).unwrap();
    for filter in [Linear, Bspline, CatmullRom] {
        assert_close(value(&a, filter), linear(at), 1e-12);
    }
    let quadratic = at.x * at.x + at.y * at.z - at.z * at.z * 3.0;
    assert_close(value(&b, CatmullRom), quadratic, 1e-12);
    assert_close(value(&b, Bspline), quadratic + (1.0 - 3.0) / 3.0, 1e-12);
    assert!((value(&b, Linear) - quadratic).abs() > 0.1);
}

/// Border voxels repeat: on the face the B-spline weighs the border voxel with 1/6 + 4/6.
#[test]
fn cubic_filters_repeat_the_border() {
    let volume = volume_of([5, 4, 4], DAffine3::IDENTITY, |[i, _, _]| f64::from(i));
    let at = |x, filter| Field::new(&volume).sample(DVec3::new(x, 0.0, 3.0), filter);
    for (x, expected) in [(0.0, 1.0 / 6.0), (1.0, 1.0), (4.0, 4.0 - 1.0 / 6.0)] {
        assert_close(at(x, Bspline).unwrap(), expected, 1e-14);
    }
    for x in [0.0, 1.0, 3.0, 4.0] {
        assert_close(at(x, CatmullRom).unwrap(), x, 1e-14);
    }
    // Voxels 0, 0, 1, 2 at the middle of the first cell: (-0 + 9 * 0 + 9 * 1 - 2) / 16.
    assert_close(at(0.5, CatmullRom).unwrap(), 7.0 / 16.0, 1e-14);
    assert_eq!(
        (at(-1e-9, Bspline), at(4.0 + 1e-9, CatmullRom)),
        (None, None)
    );
}

/// The test signal of Marschner and Lobb (1994), `f_M = 6`, `alpha = 0.25`, over `[-1,1]^3`.
struct MarschnerLobb {
    volume: Volume,
    cells: f64,
}

const FREQUENCY: f64 = 6.0;
const ALPHA: f64 = 0.25;

impl MarschnerLobb {
    fn new(n: u32) -> Self {
        let cells = f64::from(n - 1);
        let volume = volume_of([n; 3], DAffine3::IDENTITY, |v| {
            let p = DVec3::from_array(v.map(f64::from)) * (2.0 / cells) - 1.0;
            Self::smooth(p) + Self::ripple(p)
        });
        Self { volume, cells }
    }

    fn smooth(p: DVec3) -> f64 {
        (1.0 - (0.5 * PI * p.z).sin() + ALPHA) / (2.0 * (1.0 + ALPHA))
    }

    fn ripple(p: DVec3) -> f64 {
        let phase = 2.0 * PI * FREQUENCY * (0.5 * PI * p.truncate().length()).cos();
        ALPHA * phase.cos() / (2.0 * (1.0 + ALPHA))
    }

    fn gradient(p: DVec3) -> DVec3 {
        let r = p.truncate().length();
        let phase = 2.0 * PI * FREQUENCY * (0.5 * PI * r).cos();
        let by_r = ALPHA * phase.sin() * 2.0 * PI * FREQUENCY * 0.5 * PI * (0.5 * PI * r).sin();
        let across = p.truncate() / r * by_r;
        let along = -0.5 * PI * (0.5 * PI * p.z).cos();
        across.extend(along) / (2.0 * (1.0 + ALPHA))
    }

    /// Points inside, up to 0.9 from the centre, and their index positions.
    fn points(&self) -> impl Iterator<Item = (DVec3, DVec3)> {
        let directions = directions(umbravox::scene::DirectionSet::Fibonacci, 5_000);
        directions.into_iter().enumerate().map(|(i, d)| {
            let radius = 0.9 * ((i as f64 + 0.5) * 0.618_034).fract().cbrt();
            let p = DVec3::from_array(d) * radius;
            (p, (p + 1.0) * (0.5 * self.cells))
        })
    }

    /// Root mean square and largest error, and the share of the ripple's amplitude that is left.
    fn value_errors(&self, filter: Interpolation) -> [f64; 3] {
        let field = Field::new(&self.volume);
        let (mut squares, mut largest, mut count) = (0.0, 0f64, 0.0);
        let (mut product, mut norm) = (0.0, 0.0);
        for (p, ix) in self.points() {
            let (value, ripple) = (field.sample(ix, filter).unwrap(), Self::ripple(p));
            let error = value - Self::smooth(p) - ripple;
            squares += error * error;
            largest = largest.max(error.abs());
            product += (value - Self::smooth(p)) * ripple;
            norm += ripple * ripple;
            count += 1.0;
        }
        [(squares / count).sqrt(), largest, product / norm]
    }

    /// Mean angle to the true gradient, degrees.
    fn gradient_error(&self, estimator: Gradient) -> f64 {
        let field = Field::new(&self.volume);
        let angles = self.points().map(|(p, ix)| {
            let estimate = field.gradient_ws(ix, estimator).unwrap();
            estimate.angle_between(Self::gradient(p)).to_degrees()
        });
        angles.sum::<f64>() / self.points().count() as f64
    }
}

/// The finer the filter the closer; the B-spline is smooth at the cost of amplitude.
#[test]
fn errors_on_the_signal_of_marschner_and_lobb() {
    println!("voxels  filter      rms error  largest  amplitude left");
    for n in [41, 61, 81] {
        let signal = MarschnerLobb::new(n);
        let errors = [Nearest, Linear, Bspline, CatmullRom].map(|filter| {
            let [rms, largest, amplitude] = signal.value_errors(filter);
            let name = format!("{filter:?}");
            println!("{n}^3    {name:<10}  {rms:.5}    {largest:.5}  {amplitude:.4}");
            [rms, largest, amplitude]
        });
        let [nearest, linear, bspline, catmull_rom] = errors;
        assert!(nearest[0] > linear[0] && linear[0] > catmull_rom[0], "{n}");
        assert!(nearest[1] > linear[1] && linear[1] > catmull_rom[1], "{n}");
        assert!(bspline[2] < linear[2] && linear[2] < catmull_rom[2], "{n}");
    }
}

/// Four taps and cubic derivatives are closer than two; estimators that smooth lose the ripples' slope.
#[test]
fn gradient_errors_on_the_signal_of_marschner_and_lobb() {
    println!("voxels  estimator            mean angle to the true gradient");
    for n in [41, 61, 81] {
        let signal = MarschnerLobb::new(n);
        let error = |estimator| {
            let degrees = signal.gradient_error(estimator);
            let name = format!("{estimator:?}");
            println!("{n}^3    {name:<19}  {degrees:.3} degrees");
            degrees
        };
        let central = error(Gradient::CentralDifferences);
        let four_point = error(Gradient::FourPoint);
        let [regression, sobel] = [Gradient::Regression, Gradient::Sobel].map(error);
        let [bspline, catmull_rom] = [Gradient::Bspline, Gradient::CatmullRom].map(error);
        assert!(
            four_point < central && central < sobel && sobel < regression,
            "{n}"
        );
        assert!(bspline.max(catmull_rom) < central, "{n}");
    }
}
