//! Cube maps: six square images around the viewer, without seams.

#[cfg(test)]
mod tests;

use crate::appearance::texture::{Image, TextureFilter, Wrap};
use crate::base::color::Rgb;
use crate::base::digest::Content;
use crate::base::lanes::{Color, Mask, Real, Row, Vec3, lanes};
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

/// Points of faces. `s` runs from -1 at the left to 1, `t` from -1 at the top to 1.
struct FacePoint<F: Real> {
    /// The index of the face.
    face: F,
    s: F,
    t: F,
    /// False for directions that are zero or not finite.
    is_valid: F::Mask,
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

    /// Radiance from directions of any length. It is black if a direction is zero or not finite.
    #[inline(always)]
    pub fn radiance<F: Real>(&self, direction: Vec3<F>) -> Color<F::F32> {
        let FacePoint { face, s, t, is_valid } = face_point(direction);
        let [(columns, rights), (rows, downs)] = [s, t].map(|along| self.texel_before(along));
        let (faces, columns, rows) =
            (face.to_u32().to_array(), columns.to_u32().to_array(), rows.to_u32().to_array());
        let (rights, downs) = (rights.to_array(), downs.to_array());
        let black = F::F32::splat(0.0).to_array();
        let (mut r, mut g, mut b) = (black, black, black);
        let across = self.size as usize + 2;
        for lane in lanes(is_valid.bits()) {
            let (face, column, row) = (faces[lane] as usize, columns[lane] as usize, rows[lane] as usize);
            let first = (face * across + row) * across + column;
            let along = |at: usize| self.values[at].lerp(self.values[at + 1], rights[lane]);
            (r[lane], g[lane], b[lane]) = along(first).lerp(along(first + across), downs[lane]).into();
        }
        Color { r: F::F32::from_array(r), g: F::F32::from_array(g), b: F::F32::from_array(b) }
    }

    /// Radiance from one direction.
    pub fn radiance_from(&self, direction: DVec3) -> Rgb {
        self.radiance::<f64>(direction.into()).into()
    }

    /// The indices of the values at or before points in -1..=1 of a row or column, and the fractions of the way to the
    /// next values.
    #[inline(always)]
    fn texel_before<F: Real>(&self, along: F) -> (F, F::F32) {
        let (size, half, two) = (F::splat(f64::from(self.size)), F::splat(0.5), F::splat(2.0));
        let at = (half * along + half) * size + half;
        let before = at.floor();
        let share = at - before;
        // The border is half a texel from the first and from the last texel.
        let at_end = F::select(before.eq(size), two * share, share);
        let share = F::select(before.eq(F::splat(0.0)), two * share - F::splat(1.0), at_end);
        (before, share.to_f32())
    }
}

/// The faces in directions, and their points there, as [`AXES`] say.
#[inline(always)]
fn face_point<F: Real>(direction: Vec3<F>) -> FacePoint<F> {
    let Vec3 { x, y, z } = direction;
    let (zero, one, size) = (F::splat(0.0), F::splat(1.0), direction.abs());
    let along_x = size.y.le(size.x) & size.z.le(size.x);
    let along_y = !along_x & size.z.le(size.y);
    let longest = F::select(along_x, size.x, F::select(along_y, size.y, size.z));
    let forward = F::select(along_x, x, F::select(along_y, y, z));
    let back = forward.lt(zero);
    let axis = F::select(along_x, zero, F::select(along_y, F::splat(2.0), F::splat(4.0)));
    let right = F::select(along_x, F::select(back, z, -z), F::select(back & !along_y, -x, x));
    let down = F::select(along_y, F::select(back, -z, z), -y);
    let (s, t) = (right / longest, down / longest);
    // No component exceeds the largest one, and the rounded quotient does not exceed 1.
    let is_valid = zero.lt(longest) & longest.lt(F::splat(f64::INFINITY)) & s.abs().le(one) & t.abs().le(one);
    let [s, t] = [s, t].map(|along| F::select(is_valid, along, zero));
    FacePoint { face: axis + F::select(back, one, zero), s, t, is_valid }
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
    let FacePoint { face, s, t, is_valid } = face_point::<f64>(direction.into());
    let uv = DVec2::new(0.5 + 0.5 * s, 0.5 - 0.5 * t);
    let sample = || faces[face as usize].sample(uv, [Wrap::Clamp.into(); 2], TextureFilter::Bilinear);
    if is_valid { sample() } else { Rgb::ZERO }
}
