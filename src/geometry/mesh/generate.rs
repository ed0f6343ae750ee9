//! Generated meshes of any size, for tests and scaling measurements.

use super::data::MeshData;
use crate::base::color::Rgb;
use crate::base::math::DVec3;
use std::collections::HashMap;

/// The unit icosphere: 20·4^n triangles for n subdivisions (at most 12). Neighbours share their vertices.
pub fn icosphere(subdivisions: u32) -> MeshData {
    let golden = (1.0 + 5.0_f64.sqrt()) / 2.0;
    // Three perpendicular golden rectangles.
    let corners = [(-1.0, golden), (1.0, golden), (-1.0, -golden), (1.0, -golden)];
    let rectangle = |turn: usize| {
        corners.map(|(a, b)| {
            let mut p = [0.0; 3];
            (p[turn], p[(turn + 1) % 3]) = (a, b);
            DVec3::from_array(p).normalize()
        })
    };
    let mut positions: Vec<_> = [0, 1, 2].into_iter().flat_map(rectangle).collect();
    let mut triangles = FACES.to_vec();
    for _ in 0..subdivisions.min(12) {
        triangles = subdivided(&triangles, &mut positions);
    }
    MeshData { positions, triangles, ..MeshData::default() }
}

/// The faces of an icosahedron, counter-clockwise from outside.
const FACES: [[u32; 3]; 20] = [
    [0, 11, 5],
    [0, 5, 1],
    [0, 1, 7],
    [0, 7, 10],
    [0, 10, 11],
    [1, 5, 9],
    [5, 11, 4],
    [11, 10, 2],
    [10, 7, 6],
    [7, 1, 8],
    [3, 9, 4],
    [3, 4, 2],
    [3, 2, 6],
    [3, 6, 8],
    [3, 8, 9],
    [4, 9, 5],
    [2, 4, 11],
    [6, 2, 10],
    [8, 6, 7],
    [9, 8, 1],
];

/// Splits every triangle into four. New vertices lie on the unit sphere above the middles of the edges.
fn subdivided(triangles: &[[u32; 3]], positions: &mut Vec<DVec3>) -> Vec<[u32; 3]> {
    let mut middles = HashMap::with_capacity(triangles.len() * 3 / 2);
    let mut middle = |p: u32, q: u32| {
        *middles.entry((p.min(q), p.max(q))).or_insert_with(|| {
            positions.push((positions[p as usize] + positions[q as usize]).normalize());
            positions.len() as u32 - 1
        })
    };
    let split = |&[a, b, c]: &[u32; 3]| {
        let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
        [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
    };
    triangles.iter().flat_map(split).collect()
}

/// Number of superposed waves. Each is shorter and lower than the previous one.
const WAVES: u32 = 24;

/// An icosphere with hills of about a tenth of its radius, coloured by height: sand below, snow above.
/// Positions are f32 numbers, so that files of either format hold them exactly.
pub fn displaced_sphere(subdivisions: u32, seed: u64) -> MeshData {
    let mut data = icosphere(subdivisions);
    let waves = waves(seed);
    data.colors.reserve(data.positions.len());
    for position in &mut data.positions {
        let height: f64 = waves.iter().map(|wave| wave.height(*position)).sum();
        *position = (*position * (1.0 + height)).as_vec3().as_dvec3();
        let share = (0.5 + 3.0 * height).clamp(0.0, 1.0) as f32;
        data.colors.push(Rgb::new(0.55, 0.35, 0.16).lerp(Rgb::new(0.9, 0.92, 0.95), share));
    }
    data
}

struct Wave {
    along: DVec3,
    phase: f64,
    amplitude: f64,
}

impl Wave {
    fn height(&self, position: DVec3) -> f64 {
        self.amplitude * libm::sin(self.along.dot(position) + self.phase)
    }
}

fn waves(seed: u64) -> Vec<Wave> {
    let mut state = seed;
    // splitmix64 (Steele, Lea, Flood 2014), from -1 to 1.
    let mut random = || {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        2.0 * ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64 - 1.0
    };
    let mut frequency = 2.0_f64;
    let wave = |_| {
        let direction = DVec3::new(random(), random(), random()).normalize_or(DVec3::Y);
        frequency *= 1.22;
        // Short waves are flatter as well as lower.
        let amplitude = 0.2 / (frequency * frequency.sqrt());
        Wave { along: direction * frequency, phase: std::f64::consts::PI * random(), amplitude }
    };
    (0..WAVES).map(wave).collect()
}
