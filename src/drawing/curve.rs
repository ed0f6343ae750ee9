//! The curves of letters as polylines.

use ab_glyph::{OutlineCurve, Point};

/// A Bézier curve of degree one to three, by its control points.
pub struct Curve {
    points: [[f32; 2]; 4],
    degree: usize,
}

impl Curve {
    /// A curve of an outline, each point of which `at` moves to its place.
    pub fn new(curve: &OutlineCurve, at: impl Fn(Point) -> [f32; 2]) -> Self {
        let (degree, [a, b, c, d]) = match *curve {
            OutlineCurve::Line(a, b) => (1, [a, b, b, b]),
            OutlineCurve::Quad(a, c, b) => (2, [a, c, b, b]),
            OutlineCurve::Cubic(a, c, d, b) => (3, [a, c, d, b]),
        };
        Self { points: [at(a), at(b), at(c), at(d)], degree }
    }

    pub fn first(&self) -> [f32; 2] {
        self.points[0]
    }

    pub fn last(&self) -> [f32; 2] {
        self.points[self.degree]
    }

    /// The ends of chords that are within `flatness` of the curve, the first point left out.
    pub fn chords(&self, flatness: f32) -> impl Iterator<Item = [f32; 2]> + '_ {
        let pieces = self.pieces(flatness);
        (1..=pieces).map(move |piece| match piece == pieces {
            true => self.last(),
            false => self.at(piece as f32 / pieces as f32),
        })
    }

    /// Pieces of equal parameters whose chords are flat enough. A chord of a piece of length h is within h² |B''| / 8 of
    /// the curve, and the second derivative of degree n is at most n (n - 1) times the second differences.
    fn pieces(&self, flatness: f32) -> u32 {
        let bends = self.points[..=self.degree].array_windows().map(|[a, b, c]| {
            let second = [0, 1].map(|axis: usize| a[axis] - 2.0 * b[axis] + c[axis]);
            second[0].abs() + second[1].abs()
        });
        let bend = bends.fold(0.0f32, f32::max) * (self.degree * (self.degree - 1)) as f32 / 8.0;
        (bend / flatness).sqrt().ceil().clamp(1.0, 64.0) as u32
    }

    /// De Casteljau's algorithm.
    fn at(&self, share: f32) -> [f32; 2] {
        let mut points = self.points;
        for left in (1..=self.degree).rev() {
            for index in 0..left {
                let mix = |axis: usize| points[index][axis] * (1.0 - share) + points[index + 1][axis] * share;
                points[index] = [mix(0), mix(1)];
            }
        }
        points[0]
    }
}
