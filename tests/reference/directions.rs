//! Direction sets cover the sphere evenly.

use glam::DVec3;
use umbravox::scene::DirectionSet::{self, Fibonacci, Icosahedron, Octahedron, Tetrahedron};
use umbravox::scene::directions;

use crate::fixtures::assert_close;

const SOLIDS: [(DirectionSet, &[usize]); 3] = [
    (Tetrahedron, &[4, 10, 34, 130]),
    (Octahedron, &[6, 18, 66, 258]),
    (Icosahedron, &[12, 42, 162, 642, 2562]),
];

fn unit_directions(set: DirectionSet, count: usize) -> Vec<DVec3> {
    let dirs = directions(set, count as u32);
    dirs.into_iter().map(DVec3::from_array).collect()
}

/// Every set at every size of interest.
fn sets() -> impl Iterator<Item = (DirectionSet, usize)> {
    let solids = SOLIDS
        .into_iter()
        .flat_map(|(set, counts)| counts.iter().map(move |&n| (set, n)));
    solids.chain([1, 2, 3, 7, 8, 16, 32, 64, 128, 999].map(|n| (Fibonacci, n)))
}

#[test]
fn counts_are_those_of_the_subdivisions() {
    for (set, counts) in SOLIDS {
        let mut at_least = 0;
        for &count in counts {
            // The smallest subdivision that has enough, from one more than the last up to its own count.
            assert_eq!(directions(set, at_least as u32 + 1).len(), count, "{set:?}");
            assert_eq!(directions(set, count as u32).len(), count, "{set:?}");
            at_least = count;
        }
    }
    for count in 1..200 {
        assert_eq!(directions(Fibonacci, count).len(), count as usize);
    }
}

#[test]
fn directions_are_distinct_and_of_unit_length() {
    for (set, count) in sets() {
        let dirs = unit_directions(set, count);
        // Distances between neighbours of an even cover are near sqrt(4 pi / n).
        let expected = (4.0 * std::f64::consts::PI / count as f64).sqrt();
        for (i, a) in dirs.iter().enumerate() {
            assert_close(a.length(), 1.0, 1e-14);
            for b in &dirs[..i] {
                assert!(a.distance(*b) > 0.4 * expected, "{set:?} {count}: {a} {b}");
            }
        }
    }
}

#[test]
fn directions_balance() {
    for (set, count) in sets() {
        let sum: DVec3 = unit_directions(set, count).iter().sum();
        if set == Fibonacci {
            // Heights cancel exactly; the spiral leaves about half a direction around the axis.
            assert_close(sum.z, 0.0, 1e-12);
            assert!(sum.length() <= 1.0, "{count}: {sum}");
        } else {
            assert!(sum.length() < 1e-11, "{set:?} {count}: {sum}");
        }
    }
}

/// The cap that is one direction's share of the sphere has the (flat) radius `2 / sqrt(n)`. No point is
/// farther from a direction than 1.4 of that; a subdivided tetrahedron, uneven as it is, 2.
#[test]
fn directions_leave_no_gap() {
    let probes = unit_directions(Fibonacci, 3000);
    for (set, count) in sets().filter(|&(_, n)| n >= 4) {
        let dirs = unit_directions(set, count);
        let nearest = |p: &DVec3| dirs.iter().map(|d| d.distance(*p)).fold(9.0, f64::min);
        let gap = probes.iter().map(nearest).fold(0.0, f64::max);
        let shares = gap * (count as f64).sqrt() / 2.0;
        let limit = if set == Tetrahedron { 2.0 } else { 1.4 };
        assert!(shares < limit, "{set:?} {count}: {shares} >= {limit}");
    }
}

/// A light volume is refined by one direction after another: the first ones must not all lie on one side,
/// and what has been traced is far apart.
#[test]
fn early_directions_are_spread() {
    for (set, count) in sets().filter(|&(_, n)| n >= 32) {
        let dirs = unit_directions(set, count);
        for first in [4, 8, 16] {
            let mean = dirs[..first].iter().sum::<DVec3>() / first as f64;
            assert!(
                mean.length() < 0.35,
                "{set:?} {count}: first {first}: {}",
                mean.length()
            );
            for (i, a) in dirs[..first].iter().enumerate() {
                for b in &dirs[..i] {
                    let apart = a.distance(*b) * (first as f64).sqrt() / 2.0;
                    assert!(
                        apart > 0.9,
                        "{set:?} {count}: first {first}: {apart} shares apart"
                    );
                }
            }
        }
    }
}
