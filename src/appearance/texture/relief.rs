//! Relief: shading normals of surfaces that a texture raises, without displacing them.
//!
//! Heights raise the surface along its normal n (Blinn, *Simulation of wrinkled surfaces*, 1978). The raised surface has
//! the normal n - ∇h with the gradient along the surface (Mikkelsen, *Bump mapping unparametrized surfaces on the GPU*,
//! 2010), which needs no coordinates. The gradient is that of the texture over the footprint of the pixel, so finer
//! relief than pixels resolve fades.

use super::{Texture, TextureEvalContext, TextureInputs};
use crate::base::color::Rgb;
use crate::base::digest::{Content, Digester};
use crate::base::lanes::Vec3;
use crate::base::math::{DVec2, DVec3};
use crate::geometry::shape::Shape;

/// How strongly a relief raises a surface: its depth or its factor; 0 without relief.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ReliefStrength(pub f64);

/// Materials without relief have the digest that they had before there was any.
impl Content for ReliefStrength {
    fn feed(&self, into: &mut Digester) {
        if self.0 != 0.0 {
            self.0.feed(into);
        }
    }
}

/// The shortest step of differences in units of the size of the shape, or of 1 if it is infinite. Colours are f32: over
/// shorter steps, their rounding would show.
const SHORTEST: f64 = 1.0 / (1 << 14) as f64;

/// The point, and its neighbours at a distance along two directions across the normal.
struct Neighbours<'a> {
    context: &'a TextureEvalContext<'a>,
    /// What is read at the neighbours.
    inputs: TextureInputs,
    axes: [DVec3; 2],
    distance: f64,
}

impl<'a> Neighbours<'a> {
    fn new(context: &'a TextureEvalContext<'a>, inputs: TextureInputs, normal: DVec3) -> Self {
        let (first, second) = normal.any_orthonormal_pair();
        let [a, b] = context.footprint.0.map(Vec3::length);
        let width = if a < b { a } else { b };
        let bounds = context.objects[0].shape.and_then(Shape::bounds);
        let shortest = SHORTEST * bounds.map_or(1.0, |bounds| (bounds.max - bounds.min).max_element());
        let distance = if width * 0.5 > shortest { width * 0.5 } else { shortest };
        Self { context, inputs, axes: [first, second], distance }
    }

    /// The evaluation context at a point beside.
    fn at(&self, axis: usize, side: f64) -> TextureEvalContext<'a> {
        let mut beside = *self.context;
        beside.point = beside.point + Vec3::from(self.axes[axis] * (side * self.distance));
        let Some(shape) = self.context.objects[0].shape else { return beside };
        if self.inputs.uv {
            beside.uv = shape.uv::<f64>(beside.point, beside.part);
        }
        if self.inputs.color {
            beside.color = shape.color(beside.point.into(), beside.part).into();
        }
        beside
    }

    /// The derivatives along both axes of a function of contexts, each from the mean of the differences on both sides. A
    /// side on which u or v jumps by half a map does not count: it lies beyond a seam. If u and v are not read, they stay
    /// those of the point, and no side is left out.
    fn derivatives(&self, of: impl Fn(&TextureEvalContext<'a>) -> DVec2) -> [DVec2; 2] {
        let here = of(self.context);
        [0, 1].map(|axis| {
            let (before, behind) = (self.at(axis, -1.0), self.at(axis, 1.0));
            let is_near =
                |other: &TextureEvalContext| (uv(other) - uv(self.context)).abs().max_element() <= 0.5;
            let (back, forth) = (here - of(&before), of(&behind) - here);
            let change = match [is_near(&before), is_near(&behind)] {
                [true, false] => back,
                [false, true] => forth,
                _ => (back + forth) * 0.5,
            };
            change / self.distance
        })
    }
}

/// The u and v of a point.
fn uv(context: &TextureEvalContext) -> DVec2 {
    context.uv.into()
}

/// The unit normal of a surface that `texture` raises by up to `depth`, in the space of the context. Brighter is higher.
pub fn raised(texture: &Texture, depth: f64, context: &TextureEvalContext<'_>, normal: DVec3) -> DVec3 {
    let near = Neighbours::new(context, texture.inputs(), normal);
    let height = |at: &TextureEvalContext| {
        DVec2::new(f64::from(texture.at(at, true).color.element_sum()) / 3.0 * depth, 0.0)
    };
    let [along_first, along_second] = near.derivatives(height);
    let gradient = near.axes[0] * along_first.x + near.axes[1] * along_second.x;
    (normal - gradient).try_normalize().unwrap_or(normal)
}

/// The unit normal that a normal map gives: its colours, from 0 to 1, stand for components from -1 to 1 along increasing
/// u, along increasing v and along the normal (glTF 2.0, section 3.9.3). `strength` scales the first two.
pub fn mapped(texture: &Texture, strength: f64, context: &TextureEvalContext<'_>, normal: DVec3) -> DVec3 {
    let near = Neighbours::new(context, TextureInputs { uv: true, ..TextureInputs::default() }, normal);
    let [first, second] = near.derivatives(uv);
    // The direction of increasing u at constant v solves two linear equations.
    let det = first.x * second.y - first.y * second.x;
    let tangent = (near.axes[0] * second.y - near.axes[1] * first.y) * det.signum();
    let Some(tangent) = tangent.try_normalize().filter(|_| det != 0.0) else { return normal };
    let upwards = (near.axes[1] * first.x - near.axes[0] * second.x) * det.signum();
    let across = normal.cross(tangent);
    let across = if across.dot(upwards) < 0.0 { -across } else { across };
    let given = Rgb::from(texture.at(context, true).color).as_dvec3() * 2.0 - 1.0;
    let turned = tangent * (given.x * strength) + across * (given.y * strength) + normal * given.z;
    turned.try_normalize().unwrap_or(normal)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::appearance::texture::{Image, Pattern, PatternTexture, SharedAsset, TextureSpace};
    use crate::appearance::texture::{ImageTextureTracks, TextureMappingTracks, TextureTracks, Wrap};
    use crate::base::time::Time;
    use crate::geometry::shape::{Plane, Rectangle, Sphere};
    use crate::testing::Random;

    fn image(width: u32, texels: Vec<Rgb>) -> Texture {
        let height = texels.len() as u32 / width;
        let tracks = ImageTextureTracks {
            image: SharedAsset::new(Image::new(width, height, texels).expect("an image")),
            wrap: Some(Wrap::Clamp),
            axis_wraps: None,
            filter: Default::default(),
            channel: None,
            tint: Rgb::ONE.into(),
            alpha: false,
            mapping: TextureMappingTracks::default(),
        };
        TextureTracks::Image(Box::new(tracks)).at(Time::from_integer(0))
    }

    fn context(shape: &Shape, point: DVec3) -> TextureEvalContext<'_> {
        let mut context = TextureEvalContext::nowhere();
        (context.point, context.uv) = (point.into(), shape.uv::<f64>(point.into(), 0));
        context.objects[0].shape = Some(shape);
        context
    }

    /// A ramp from black to white between the centres of two texels, over half of the square.
    #[test]
    fn ramps_tilt_the_normal_by_their_slope() {
        let square = Shape::Rectangle(Rectangle { corner: DVec3::ZERO, u: DVec3::X, v: DVec3::Y });
        let ramp = image(2, vec![Rgb::ZERO, Rgb::ONE]);
        let at = context(&square, DVec3::new(0.5, 0.4, 0.0));
        let slope = |depth: f64| raised(&ramp, depth, &at, DVec3::Z);
        let expected = DVec3::new(-2.0 * 0.25, 0.0, 1.0).normalize();
        // Colours are f32: off by 2^-25 over a step of 2^-14, times the depth.
        assert!((slope(0.25) - expected).length() < 2e-4, "{}", slope(0.25));
        assert!((slope(-0.25) - DVec3::new(0.5, 0.0, 1.0).normalize()).length() < 2e-4);
        // Beyond the last centre, the image is flat.
        let flat = context(&square, DVec3::new(0.9, 0.4, 0.0));
        assert_eq!(raised(&ramp, 0.25, &flat, DVec3::Z), DVec3::Z);
    }

    /// Heights that read no u and v have no seam: u and v change nothing, though they jump between the neighbours.
    #[test]
    fn heights_of_points_ignore_u_and_v() {
        let ball = Shape::Sphere(Sphere { center: DVec3::ZERO, radius: 1.0 });
        let noise = Texture::Pattern(Box::new(PatternTexture {
            pattern: Pattern::Noise { octaves: 2, seed: 1 },
            space: TextureSpace::Object,
            mapping: TextureMappingTracks::default().at(Time::from_integer(0)),
            first: Rgb::ZERO.into(),
            second: Rgb::ONE.into(),
        }));
        let mut random = Random(4);
        for _ in 0..1000 {
            let mut point = random.direction();
            if random.unit() < 0.5 {
                point = DVec3::new(1e-6 * random.unit(), point.y, point.z).normalize();
            }
            let at = context(&ball, point);
            let without = TextureEvalContext { uv: [0.0; 2], ..at };
            assert_eq!(raised(&noise, 0.1, &at, point), raised(&noise, 0.1, &without, point), "{point}");
        }
    }

    #[test]
    fn normal_maps_follow_u_and_v() {
        let shapes = [
            // u along -y, v along x; and a plane seen from above, with u along x and v along -z.
            (
                Shape::Rectangle(Rectangle { corner: DVec3::ZERO, u: DVec3::NEG_Y, v: DVec3::X }),
                DVec3::Z,
                [DVec3::NEG_Y, DVec3::X],
            ),
            (
                Shape::Plane(Plane { point: DVec3::ZERO, normal: DVec3::Y }),
                DVec3::Y,
                [DVec3::X, DVec3::NEG_Z],
            ),
        ];
        let map = image(1, vec![Rgb::new(0.8, 0.5, 0.9)]);
        let map_v = image(1, vec![Rgb::new(0.5, 0.8, 0.9)]);
        for (shape, normal, [u, v]) in shapes {
            let at = context(&shape, u * 0.3 + v * 0.3);
            for (map, along) in [(&map, u), (&map_v, v)] {
                let expected = (along * 0.6 * 0.5 + normal * 0.8).normalize();
                let found = mapped(map, 0.5, &at, normal);
                assert!((found - expected).length() < 1e-6, "{found} {expected}");
            }
        }
    }
}
