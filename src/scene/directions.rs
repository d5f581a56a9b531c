//! Sets of directions over the sphere.

use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Where light directions come from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum DirectionSet {
    /// Vertices of a tetrahedron, subdivided until there are enough: 4, 10, 34, 130…
    Tetrahedron,
    /// Vertices of an octahedron: 6, 18, 66, 258…
    Octahedron,
    /// Vertices of an icosahedron: 12, 42, 162, 642, 2562…
    Icosahedron,
    /// Fibonacci spiral: exactly as many as asked for.
    #[default]
    Fibonacci,
}

/// At least `count` unit directions (exactly `count` for Fibonacci; 1 at least).
///
/// The order spreads early prefixes over the sphere, so that a light volume refined by one direction a
/// frame has no preferred side while it is incomplete.
pub fn directions(set: DirectionSet, count: u32) -> Vec<[f64; 3]> {
    let mut dirs = match set {
        DirectionSet::Fibonacci => fibonacci(count.max(1)),
        DirectionSet::Tetrahedron => {
            let v = [[1., 1., 1.], [1., -1., -1.], [-1., 1., -1.], [-1., -1., 1.]];
            let f = [[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]];
            subdivide(&v, &f, count)
        }
        DirectionSet::Octahedron => {
            let v = [
                [1., 0., 0.],
                [-1., 0., 0.],
                [0., 1., 0.],
                [0., -1., 0.],
                [0., 0., 1.],
                [0., 0., -1.],
            ];
            let mut f = Vec::new();
            for x in [0, 1] {
                for y in [2, 3] {
                    for z in [4, 5] {
                        f.push([x, y, z]);
                    }
                }
            }
            subdivide(&v, &f, count)
        }
        DirectionSet::Icosahedron => {
            let p = (1.0 + 5f64.sqrt()) / 2.0;
            let mut v = Vec::new();
            for a in [-1.0, 1.0] {
                for b in [-p, p] {
                    v.push([0.0, a, b]);
                    v.push([a, b, 0.0]);
                    v.push([b, 0.0, a]);
                }
            }
            // Faces: every triple of vertices at the edge length, 2.
            let mut f = Vec::new();
            let near = |a: usize, b: usize| {
                let (a, b): ([f64; 3], [f64; 3]) = (v[a], v[b]);
                (DVec3::from(a).distance(DVec3::from(b)) - 2.0).abs() < 1e-9
            };
            for a in 0..12 {
                for b in a + 1..12 {
                    for c in b + 1..12 {
                        if near(a, b) && near(b, c) && near(a, c) {
                            f.push([a, b, c]);
                        }
                    }
                }
            }
            subdivide(&v, &f, count)
        }
    };
    spread(&mut dirs);
    dirs.into_iter().map(|d| d.to_array()).collect()
}

/// `count` points of equal area on a golden-angle spiral.
fn fibonacci(count: u32) -> Vec<DVec3> {
    let golden_angle = std::f64::consts::PI * (3.0 - 5f64.sqrt());
    (0..count)
        .map(|i| {
            let z = 1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(count);
            let r = (1.0 - z * z).sqrt();
            let (s, c) = (golden_angle * f64::from(i)).sin_cos();
            DVec3::new(r * c, r * s, z)
        })
        .collect()
}

/// Splits each face into four until there are at least `count` vertices; all are pushed onto the unit sphere.
fn subdivide(vertices: &[[f64; 3]], faces: &[[usize; 3]], count: u32) -> Vec<DVec3> {
    let mut v: Vec<DVec3> = vertices
        .iter()
        .map(|&p| DVec3::from(p).normalize_or_zero())
        .collect();
    let mut f = faces.to_vec();
    while v.len() < count as usize {
        let mut middle_of = std::collections::BTreeMap::new();
        let mut next = Vec::with_capacity(f.len() * 4);
        for &[a, b, c] in &f {
            let mut middle = |p: usize, q: usize| {
                *middle_of.entry((p.min(q), p.max(q))).or_insert_with(|| {
                    v.push((v[p] + v[q]).normalize_or_zero());
                    v.len() - 1
                })
            };
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            next.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
        f = next;
    }
    v
}

/// Reorders so that each direction is the farthest from all before it, and prefixes are spread out.
fn spread(dirs: &mut [DVec3]) {
    let mut distance_to_chosen = vec![f64::INFINITY; dirs.len()];
    for next in 1..dirs.len() {
        let mut farthest = next;
        for i in next..dirs.len() {
            let distance = dirs[i].distance_squared(dirs[next - 1]);
            distance_to_chosen[i] = distance_to_chosen[i].min(distance);
            if distance_to_chosen[i] > distance_to_chosen[farthest] {
                farthest = i;
            }
        }
        dirs.swap(next, farthest);
        distance_to_chosen.swap(next, farthest);
    }
}
