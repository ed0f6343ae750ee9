//! Shared test utilities: reproducible random numbers, statistics and geometry.
//!
//! In: seeds, samplers and shapes.
//! Out: random numbers, probabilities and packed geometry.
//! Uses `base`, `geometry`, `appearance`, `film` and `scene`.

mod gltf;
mod random;

pub use gltf::GltfFixture;
pub use random::Random;

use crate::appearance::material::{Exponent, Highlight, Lobes, Material, MaterialBinding, Medium};
use crate::appearance::optics::Fresnel;
use crate::base::color::Rgb;
use crate::base::lanes::{Level, Row, Vec3};
use crate::base::math::{Angle, DAffine3, DVec3, LaneRay, Ray};
use crate::film::LayerId;
use crate::geometry::shape::Shape;
use crate::scene::{Finish, Geometry};

impl Random {
    /// A uniformly distributed direction.
    pub fn direction(&mut self) -> DVec3 {
        let z = 2.0 * self.unit() - 1.0;
        let turn = Angle(360.0 * self.unit()).cos_sin();
        let r = (1.0 - z * z).sqrt();
        DVec3::new(r * turn.x, r * turn.y, z)
    }
}

/// Clear glass.
pub fn glass(ior: f64, priority: i32, fresnel: Fresnel) -> Material {
    Material {
        lobes: Lobes { refraction: Rgb::ONE, ..Lobes::default() },
        textures: Vec::new(),
        emission_layer: LayerId::CONSTANT,
        highlight: Highlight::Phong,
        shininess: Exponent::new(1.0),
        fresnel,
        medium: Medium { ior, absorption: Rgb::ZERO, priority },
        relief: Default::default(),
    }
}

/// Cells of the sphere in z and azimuth, all of the same area.
const CELLS: (usize, usize) = (20, 40);

/// The p-value of a chi-square test: the probability that a sampler with this density deviates at least as much as
/// `draw` does. Cells have equal areas, and neighbours are merged until each expects at least 5 hits. `draw` returns a
/// direction or None; `density` is per solid angle.
pub fn chi_square(
    count: u32,
    mut draw: impl FnMut() -> Option<DVec3>,
    density: impl Fn(DVec3) -> f64,
) -> f64 {
    let (rows, columns) = CELLS;
    let mut hits = vec![0.0; rows * columns];
    let mut drawn = 0.0;
    for _ in 0..count {
        let Some(d) = draw() else { continue };
        let row = ((d.z * 0.5 + 0.5) * rows as f64) as usize;
        let turn = libm::atan2(d.y, d.x) / std::f64::consts::TAU;
        let column = ((turn - turn.floor()) * columns as f64) as usize;
        hits[row.min(rows - 1) * columns + column.min(columns - 1)] += 1.0;
        drawn += 1.0;
    }
    let area = 4.0 * std::f64::consts::PI / (rows * columns) as f64;
    let expected = |cell: usize| cell_mean(cell, &density) * area * f64::from(count);
    let expected: Vec<f64> = (0..rows * columns).map(expected).collect();
    let whole: f64 = expected.iter().sum();
    // Samples without a direction are missing from the density as well.
    assert!((whole - drawn).abs() <= 4.0 * whole.sqrt() + 0.002 * whole, "{drawn} drawn, {whole} expected");
    let (mut statistic, mut freedom, mut merged) = (0.0, -1.0, (0.0, 0.0));
    for (hits, expected) in hits.iter().zip(&expected) {
        merged = (merged.0 + hits, merged.1 + expected);
        if merged.1 >= 5.0 {
            statistic += (merged.0 - merged.1) * (merged.0 - merged.1) / merged.1;
            freedom += 1.0;
            merged = (0.0, 0.0);
        }
    }
    // Wilson and Hilferty (1931): the cube root is approximately normal.
    let spread = 2.0 / (9.0 * freedom);
    let normal = (libm::cbrt(statistic / freedom) - (1.0 - spread)) / libm::sqrt(spread);
    0.5 * libm::erfc(normal / std::f64::consts::SQRT_2)
}

/// The mean of a density over a cell, from a grid of points.
fn cell_mean(cell: usize, density: impl Fn(DVec3) -> f64) -> f64 {
    const POINTS: usize = 24;
    let (rows, columns) = CELLS;
    let at = |i: usize| {
        let (a, b) = ((i % POINTS) as f64 + 0.5, (i / POINTS) as f64 + 0.5);
        let z = 2.0 * ((cell / columns) as f64 + a / POINTS as f64) / rows as f64 - 1.0;
        let turn = ((cell % columns) as f64 + b / POINTS as f64) / columns as f64;
        let across = Angle(360.0 * turn).cos_sin() * (1.0 - z * z).sqrt();
        density(DVec3::new(across.x, across.y, z))
    };
    (0..POINTS * POINTS).map(at).sum::<f64>() / (POINTS * POINTS) as f64
}

/// Packs eight rays into lanes.
#[inline(always)]
pub fn eight_rays<L: Level>(rays: &[Ray; 8]) -> LaneRay<L::F64> {
    let (mut origins, mut directions) = ([DVec3::ZERO; 8], [DVec3::ZERO; 8]);
    for lane in 0..8 {
        (origins[lane], directions[lane]) = (rays[lane].origin, rays[lane].direction);
    }
    LaneRay { origin: eight_vectors::<L>(origins), direction: eight_vectors::<L>(directions) }
}

/// Packs eight vectors into lanes.
#[inline(always)]
pub fn eight_vectors<L: Level>(all: [DVec3; 8]) -> Vec3<L::F64> {
    let (mut x, mut y, mut z) = ([0.0; 8], [0.0; 8], [0.0; 8]);
    for lane in 0..8 {
        (x[lane], y[lane], z[lane]) = (all[lane].x, all[lane].y, all[lane].z);
    }
    Vec3::new(L::F64::from_array(x), L::F64::from_array(y), L::F64::from_array(z))
}

/// Shapes with the first material, not transformed.
pub fn geometry(shapes: impl IntoIterator<Item = Shape>) -> Geometry {
    let mut geometry = Geometry::default();
    shapes.into_iter().for_each(|shape| {
        geometry.push(&shape, DAffine3::IDENTITY, Finish::Material(MaterialBinding::One(0)))
    });
    geometry
}
