//! Cube maps: six square images around the viewer, without seams.

#[cfg(test)]
mod tests;

use crate::appearance::texture::{Image, TextureFilter, Wrap};
use crate::base::color::Rgb;
use crate::base::digest::Content;
use crate::base::math::{DVec2, DVec3};

/// The names of the faces, in order: towards +x, -x, +y, -y, +z and -z.
pub const FACES: [&str; 6] = ["px", "nx", "py", "ny", "pz", "nz"];

/// The axes of each face, as in the cube maps of OpenGL and Direct3D:
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
/// This is the view from inside in left-handed axes. In right-handed axes the images appear mirrored.
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

/// Six square images of one size. Between the texels of two faces, the map stores values on their common edge, and one
/// at each corner of three faces. Each face has these values as its border. So filtering gives the same value on both
/// sides of an edge.
#[derive(Clone, Debug, PartialEq, Content)]
pub struct CubeMap {
    /// Texels along an edge.
    size: u32,
    /// Face by face, row by row from the top left, (size + 2)² values each: texels at their centres, and around them
    /// the border on the edge itself, half a texel away.
    values: Vec<Rgb>,
    /// Whether any of the images has alpha, which a sky ignores.
    pub has_alpha: bool,
}

/// Why six images do not form a cube map. The number is the index of the face in [`FACES`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FacesError {
    NotSquare(usize),
    /// Its size differs from that of the first face.
    Differs(usize),
}

/// A point of a face. `s` runs from -1 at the left to 1, `t` from -1 at the top to 1.
struct FacePoint {
    face: usize,
    s: f64,
    t: f64,
}

impl CubeMap {
    /// Builds a cube map from images in the order of [`FACES`].
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

    /// Radiance from a direction of any length. It is black if the direction is zero or not finite.
    pub fn radiance(&self, direction: DVec3) -> Rgb {
        let Some(FacePoint { face, s, t }) = face_point(direction) else { return Rgb::ZERO };
        let [(column, right), (row, down)] = [s, t].map(|along| self.texel_before(along));
        let across = self.size as usize + 2;
        let first = (face * across + row) * across + column;
        let row = |at: usize| self.values[at].lerp(self.values[at + 1], right);
        row(first).lerp(row(first + across), down)
    }

    /// The index of the value at or before a point in -1..=1 of a row or column, and the fraction of the way to the
    /// next value.
    fn texel_before(&self, along: f64) -> (usize, f32) {
        let at = (0.5 * along + 0.5) * f64::from(self.size) + 0.5;
        let before = at.floor();
        // The border is half a texel from the first and from the last texel.
        let share = match (before as usize, at - before) {
            (0, share) => 2.0 * share - 1.0,
            (last, share) if last == self.size as usize => 2.0 * share,
            (_, share) => share,
        };
        (before as usize, share as f32)
    }
}

/// The face and its point in a direction. It is `None` if the direction is zero or not finite.
fn face_point(direction: DVec3) -> Option<FacePoint> {
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
    // No component exceeds the largest one, and the rounded quotient does not exceed 1.
    on_cube.is_finite().then(|| {
        let axes = &AXES[face];
        FacePoint { face, s: on_cube.dot(axes.right), t: on_cube.dot(axes.down) }
    })
}

/// The value at index 0..=size + 1 along each axis of a face. Inside it is a texel. On the border it is the mean of the
/// two or three faces that meet there, each sampled at the centres of its outermost texels.
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
    touching.iter().map(|direction| lookup(faces, *direction)).sum::<Rgb>() / touching.len() as f32
}

/// The colour in a direction, filtered within one face.
fn lookup(faces: &[&Image; 6], direction: DVec3) -> Rgb {
    face_point(direction).map_or(Rgb::ZERO, |FacePoint { face, s, t }| {
        let uv = DVec2::new(0.5 + 0.5 * s, 0.5 - 0.5 * t);
        faces[face].sample(uv, [Wrap::Clamp.into(); 2], TextureFilter::Bilinear)
    })
}
