//! Cube maps: six pictures around, without seams between them.

#[cfg(test)]
mod tests;

use crate::appearance::texture::{Filter, Image, Wrap};
use crate::base::color::Rgb;
use crate::base::digest::content;
use crate::base::math::{DVec2, DVec3};

/// The names of the faces in their order: towards +x, -x, +y, -y, +z and -z.
pub const FACES: [&str; 6] = ["px", "nx", "py", "ny", "pz", "nz"];

/// Where each face's picture runs to the right and where it runs down, as OpenGL's and Direct3D's cube maps:
///
/// | face | right | up |
/// |---|---|---|
/// | px | -z | +y |
/// | nx | +z | +y |
/// | py | +x | -z |
/// | ny | +x | +z |
/// | pz | +x | +y |
/// | nz | -x | +y |
///
/// That is the view from inside in left-handed axes; in right-handed ones the pictures are seen mirrored.
const AXES: [Axes; 6] = [
    Axes { forward: DVec3::X, right: DVec3::NEG_Z, down: DVec3::NEG_Y },
    Axes { forward: DVec3::NEG_X, right: DVec3::Z, down: DVec3::NEG_Y },
    Axes { forward: DVec3::Y, right: DVec3::X, down: DVec3::Z },
    Axes { forward: DVec3::NEG_Y, right: DVec3::X, down: DVec3::NEG_Z },
    Axes { forward: DVec3::Z, right: DVec3::X, down: DVec3::NEG_Y },
    Axes { forward: DVec3::NEG_Z, right: DVec3::NEG_X, down: DVec3::NEG_Y },
];

struct Axes {
    forward: DVec3,
    right: DVec3,
    down: DVec3,
}

/// Six square pictures of one size. Between the texels of two faces lie values on their common edge, and one
/// on the corner of three, which every face has as its own border: what is filtered on one side of an edge
/// ends where the other side begins.
#[derive(Clone, Debug, PartialEq)]
pub struct CubeMap {
    /// Texels along an edge.
    size: u32,
    /// Face by face, row by row from the top left, (size + 2)² values each: texels at their centres, and
    /// around them the border on the very edge, half a texel away.
    values: Vec<Rgb>,
    /// Whether any of the pictures has alpha, which a sky does not show.
    pub has_alpha: bool,
}

content!(struct CubeMap { size, values, has_alpha });

/// Why six images make no cube map; the number is the face's index in [`FACES`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FacesError {
    NotSquare(usize),
    /// Another size than the first face.
    Differs(usize),
}

/// A place on a face, in -1..=1 from the left and from the top.
struct Place {
    face: usize,
    s: f64,
    t: f64,
}

impl CubeMap {
    /// A cube map of images in the order of [`FACES`].
    pub fn new(faces: [&Image; 6]) -> Result<Self, FacesError> {
        let size = faces[0].width();
        for (index, face) in faces.iter().enumerate() {
            if face.width() != face.height() {
                return Err(FacesError::NotSquare(index));
            }
            if face.width() != size {
                return Err(FacesError::Differs(index));
            }
        }
        let across = size + 2;
        let places =
            (0..6).flat_map(|face| (0..across * across).map(move |i| (face, [i % across, i / across])));
        let values = places.map(|(face, at)| value(&faces, face, at)).collect();
        let has_alpha = faces.iter().any(|face| face.has_alpha());
        Ok(Self { size, values, has_alpha })
    }

    /// Texels along an edge of a face.
    pub fn size(&self) -> u32 {
        self.size
    }

    /// Radiance from a direction of any length; black from none.
    pub fn radiance(&self, direction: DVec3) -> Rgb {
        let Some(Place { face, s, t }) = place(direction) else { return Rgb::ZERO };
        let [(column, right), (row, down)] = [s, t].map(|along| self.between(along));
        let across = self.size as usize + 2;
        let first = (face * across + row) * across + column;
        let row = |at: usize| self.values[at].lerp(self.values[at + 1], right);
        row(first).lerp(row(first + across), down)
    }

    /// The value before a place in -1..=1 along a row or column, and how far it is to the next one.
    fn between(&self, along: f64) -> (usize, f32) {
        let at = (0.5 * along + 0.5) * f64::from(self.size) + 0.5;
        let before = at.floor();
        // The border is half a texel away from the first and the last one.
        let share = match (before as usize, at - before) {
            (0, share) => 2.0 * share - 1.0,
            (last, share) if last == self.size as usize => 2.0 * share,
            (_, share) => share,
        };
        (before as usize, share as f32)
    }
}

/// The face that a direction meets, and where; none for directions without one.
fn place(direction: DVec3) -> Option<Place> {
    let size = direction.abs();
    let axis = if size.x >= size.y && size.x >= size.z {
        0
    } else if size.y >= size.z {
        1
    } else {
        2
    };
    let face = 2 * axis + usize::from(direction[axis] < 0.0);
    let on_cube = direction / size[axis];
    // No part is longer than the longest, and its quotient is not rounded beyond 1.
    on_cube.is_finite().then(|| {
        let axes = &AXES[face];
        Place { face, s: on_cube.dot(axes.right), t: on_cube.dot(axes.down) }
    })
}

/// The value at index 0..=size + 1 along each axis of a face: a texel, or on the border the mean of the two or
/// three faces that meet there, each at the centres of its outermost texels.
fn value(faces: &[&Image; 6], face: usize, at: [u32; 2]) -> Rgb {
    let last = faces[face].width() + 1;
    let side = at.map(|i| if i == 0 { -1.0 } else { f64::from(u8::from(i == last)) });
    if side == [0.0; 2] {
        return faces[face].texel(at[0] - 1, at[1] - 1);
    }
    let size = f64::from(last - 1);
    let rim = 1.0 - 1.0 / size;
    // The mean of (1, rim, t) and (rim, 1, t) points to the edge where t is larger by a factor.
    let along = |i: u32| ((2.0 * f64::from(i) - 1.0) / size - 1.0) * (1.0 - 0.5 / size);
    let [s, t] = [0, 1].map(|axis| if side[axis] == 0.0 { along(at[axis]) } else { side[axis] * rim });
    let Axes { forward, right, down } = &AXES[face];
    let here = Some(forward + right * s + down * t);
    let beside = (side[0] != 0.0).then(|| forward * rim + right * side[0] + down * t);
    let below = (side[1] != 0.0).then(|| forward * rim + right * s + down * side[1]);
    let touching: Vec<_> = [here, beside, below].into_iter().flatten().collect();
    touching.iter().map(|direction| seen(faces, *direction)).sum::<Rgb>() / touching.len() as f32
}

/// What the face in a direction shows, without regard to the others.
fn seen(faces: &[&Image; 6], direction: DVec3) -> Rgb {
    place(direction).map_or(Rgb::ZERO, |Place { face, s, t }| {
        let uv = DVec2::new(0.5 + 0.5 * s, 0.5 - 0.5 * t);
        faces[face].sample(uv, [Wrap::Clamp.into(); 2], Filter::Bilinear)
    })
}
