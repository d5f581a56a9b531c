//! Rays, the part of them inside the field, and its segments.

use glam::{DAffine3, DVec3};

/// A remainder below this share of a step is rounding noise and lengthens the segment before it instead of
/// being one of its own: a length of `3.00001` steps has three segments, the last `1.00001` steps long.
pub const MERGED_REMAINDER: f64 = 1e-4;

/// A half line in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Start, mm.
    pub origin: DVec3,
    /// Unit length.
    pub direction: DVec3,
}

/// The part of a ray inside the field: distances from its origin, mm, `0 <= enter <= exit`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    /// Where the ray enters, or 0 when it starts inside.
    pub enter: f64,
    /// Where it leaves.
    pub exit: f64,
}

/// A part of a ray that is sampled once, at its middle. Distances from the ray's origin, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// Near end.
    pub start: f64,
    /// Far end.
    pub end: f64,
}

impl Segment {
    /// Where it is sampled.
    pub fn middle(self) -> f64 {
        0.5 * (self.start + self.end)
    }

    /// Length, mm.
    pub fn length(self) -> f64 {
        self.end - self.start
    }
}

impl Ray {
    /// Intersects with the box `[0, last_ix]` of index space; `None` when the ray misses it.
    ///
    /// A ray that touches the box in one point has a span of length 0. One that runs along a face is inside.
    pub fn span(self, ix_from_world: DAffine3, last_ix: DVec3) -> Option<Span> {
        let origin = ix_from_world.transform_point3(self.origin);
        let direction = ix_from_world.transform_vector3(self.direction);
        let mut span = Span {
            enter: 0.0,
            exit: f64::INFINITY,
        };
        for axis in 0..3 {
            let (o, d, last) = (origin[axis], direction[axis], last_ix[axis]);
            if d == 0.0 {
                if o < 0.0 || o > last {
                    return None;
                }
                continue;
            }
            let [a, b] = [-o / d, (last - o) / d];
            span.enter = span.enter.max(a.min(b));
            span.exit = span.exit.min(a.max(b));
        }
        (span.enter <= span.exit).then_some(span)
    }
}

impl Span {
    /// Cuts into segments of `step` mm: borders lie `(i - shift) * step` from the entry, `shift` in `[0,1)`,
    /// and the first and last segment end where the span does. A shift of 0 is the plain march; jitter
    /// draws one per ray.
    ///
    /// A last remainder below [`MERGED_REMAINDER`] of a step belongs to the segment before it; a whole span
    /// shorter than that has no segment.
    pub fn segments(self, step: f64, shift: f64) -> impl Iterator<Item = Segment> {
        let length = self.exit - self.enter;
        let count = (length / step + shift - MERGED_REMAINDER).ceil().max(0.0) as u64;
        let border = move |i: u64| self.enter + ((i as f64 - shift) * step).clamp(0.0, length);
        (0..count).map(move |i| Segment {
            start: border(i),
            end: if i + 1 == count {
                self.exit
            } else {
                border(i + 1)
            },
        })
    }
}
