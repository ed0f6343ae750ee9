//! Textures at a moment and over time.

use super::*;
use crate::base::color::Rgb;
use crate::base::lanes::{Color, Level, Mask, Portable, Real, Row, SimdKernel, Vec3, lanes};
use crate::base::math::DVec3;
use crate::base::time::Time;
use crate::testing::Random;
use crate::track::{Animated, Ease, Key, Repeat, Track};

fn context(x: f64, y: f64, z: f64) -> TextureEvalContext<'static> {
    TextureEvalContext {
        uv: [x, y],
        point: DVec3::new(x, y, z).into(),
        error: DVec3::splat(1e-14).into(),
        ..TextureEvalContext::nowhere()
    }
}

/// The colour of a texture at a point.
fn color(texture: &Texture, at: &TextureEvalContext) -> Rgb {
    texture.at(at, true).color.into()
}

fn start() -> Time {
    Time::from_integer(0)
}

fn pattern(pattern: Pattern, first: TextureTracks, second: TextureTracks) -> PatternTextureTracks {
    PatternTextureTracks {
        pattern,
        space: TextureSpace::Object,
        mapping: TextureMappingTracks::default(),
        first,
        second,
    }
}

fn image() -> ImageTextureTracks {
    let texels = vec![Rgb::X, Rgb::Y, Rgb::Z, Rgb::ONE];
    ImageTextureTracks {
        image: SharedAsset::new(Image::new(2, 2, texels).expect("an image")),
        wrap: None,
        filter: TextureFilter::Nearest,
        channel: None,
        tint: Rgb::ONE.into(),
        alpha: true,
        axis_wraps: None,
        mapping: TextureMappingTracks::default(),
    }
}

#[test]
fn patterns_nest() {
    let stripes = pattern(Pattern::Stripes, Rgb::X.into(), Rgb::Y.into());
    let image = TextureTracks::Image(Box::new(image()));
    let gradient = Pattern::Gradient { axis: DVec3::Z };
    let texture = pattern(gradient, TextureTracks::Pattern(Box::new(stripes)), image);
    let texture = TextureTracks::Pattern(Box::new(texture)).at(start());
    assert_eq!(color(&texture, &context(0.75, 0.25, -1.0)), Rgb::X, "a stripe");
    assert_eq!(color(&texture, &context(1.25, 0.25, -1.0)), Rgb::Y, "a stripe");
    assert_eq!(color(&texture, &context(0.75, 0.25, 1.0)), Rgb::ONE, "the image");
    assert_eq!(color(&texture, &context(0.25, 0.75, 0.25)), Rgb::X, "both are red here");
    assert_eq!(color(&texture, &context(1.25, 0.25, 0.5)), Rgb::new(0.0, 0.5, 0.5), "half of each");
    assert!(texture.constant().is_none());
}

#[test]
fn offset_keys_slide_a_texture() {
    let key = |time: i128, value| Key { time: Time::from_integer(time), value, ease: Ease::Linear };
    let keys = vec![key(0, DVec3::ZERO), key(1, DVec3::X)];
    let offset = Track::new(keys, Repeat::Hold, false).expect("a track");
    let mut tracks = image();
    tracks.mapping.offset = Animated::Keyed(offset);
    let seen = |num| color(&Texture::Image(tracks.at(Time::new(num, 2))), &context(0.25, 0.25, 0.0));
    assert_eq!([0, 1, 2].map(seen), [Rgb::Z, Rgb::ONE, Rgb::Z], "the image moves to the right");
}

#[test]
fn one_channel_is_grey() {
    let mut tracks = image();
    tracks.channel = Some(ColorChannel::G);
    let texture = TextureTracks::Image(Box::new(tracks)).at(start());
    assert_eq!(color(&texture, &context(0.75, 0.75, 0.0)), Rgb::ONE);
    assert_eq!(color(&texture, &context(0.25, 0.75, 0.0)), Rgb::ZERO);
}

#[test]
fn equal_paints_share_their_image() {
    let tracks = TextureTracks::Image(Box::new(image()));
    assert_eq!(tracks.at(start()), tracks.clone().at(start()));
    assert_ne!(tracks, TextureTracks::Image(Box::new(image())));
}

#[test]
fn patterns_on_a_surface_have_firm_edges_too() {
    let mut checker = pattern(Pattern::Checker, Rgb::X.into(), Rgb::Y.into());
    checker.space = TextureSpace::Uv;
    checker.mapping.scale = DVec3::splat(0.1).into();
    let checker = Texture::Pattern(Box::new(checker.at(start())));
    for k in 0..10u32 {
        let v = f64::from(k) * 0.1;
        let colors = [v - 1e-14, v, v + 1e-14].map(|v| color(&checker, &context(0.05, v, 0.0)));
        assert_eq!(colors, [[Rgb::X, Rgb::Y][k as usize % 2]; 3]);
    }
}

#[test]
fn a_color_is_constant_and_vertex_colors_are_not() {
    assert_eq!(TextureTracks::from(Rgb::X).at(start()).constant(), Some(Rgb::X));
    let vertex = TextureTracks::VertexColor.at(start());
    assert!(vertex.constant().is_none());
    assert_eq!(
        color(&vertex, &TextureEvalContext { color: Rgb::Z.into(), ..context(0.0, 0.0, 0.0) }),
        Rgb::Z
    );
}

/// Textures of all kinds, nested in one another.
fn all_kinds() -> Vec<Texture> {
    let alpha = Image::new(2, 2, vec![Rgb::X, Rgb::Y, Rgb::Z, Rgb::ONE]).expect("an image");
    let alpha = SharedAsset::new(alpha.with_alpha(vec![0.0, 0.25, 0.5, 1.0]).expect("four texels"));
    let images = [TextureFilter::Nearest, TextureFilter::Bilinear].map(|filter| {
        let mut turned =
            TextureMappingTracks { scale: DVec3::new(0.3, 0.7, 1.0).into(), ..Default::default() };
        turned.offset = DVec3::new(0.1, -0.2, 0.0).into();
        ImageTextureTracks { image: alpha.clone(), filter, mapping: turned, ..image() }
    });
    let [nearest, bilinear] = images.map(|image| TextureTracks::Image(Box::new(image)));
    let opaque = ImageTextureTracks { alpha: false, wrap: Some(Wrap::Mirror), ..image() };
    let checker = pattern(Pattern::Checker, nearest.clone(), TextureTracks::VertexColor);
    let noise = pattern(Pattern::Noise { octaves: 3, seed: 5 }, bilinear.clone(), Rgb::X.into());
    let mut stripes = pattern(Pattern::Stripes, TextureTracks::Pattern(Box::new(noise)), bilinear.clone());
    stripes.space = TextureSpace::Uv;
    let data = DataTexture {
        source: DataSource::Coordinate(1),
        scale: DataScale::Linear,
        range: Some([-1.0, 1.0]),
        auto: false,
        map: SharedAsset::new(ColorMap::named(NamedMap::Viridis, 256)),
        missing: Rgb::ONE,
    };
    let tracks = [
        nearest,
        bilinear.clone(),
        TextureTracks::Image(Box::new(opaque)),
        TextureTracks::Pattern(Box::new(checker)),
        TextureTracks::Pattern(Box::new(stripes)),
        TextureTracks::Cutout(Box::new(bilinear), 0.5),
    ];
    let mut all: Vec<Texture> = tracks.iter().map(|tracks| tracks.at(start())).collect();
    let (first, second) = (all[1].clone(), all[4].clone());
    all.push(Texture::Product(Box::new(ProductTexture { first, second })));
    all.push(Texture::Data(Box::new(data)));
    all
}

/// Evaluates a texture at eight points, of which those of a mask are wanted.
struct Eight<'a> {
    texture: &'a Texture,
    points: &'a [TextureEvalContext<'a>; 8],
    wanted: u32,
}

/// A number of each point.
#[inline(always)]
fn numbers<F: Real>(points: &[TextureEvalContext; 8], of: fn(&TextureEvalContext) -> f64) -> F {
    F::load(&points.each_ref().map(of), 0)
}

/// A vector of each point.
#[inline(always)]
fn vectors<F: Real>(points: &[TextureEvalContext; 8], of: fn(&TextureEvalContext) -> Vec3<f64>) -> Vec3<F> {
    let all = points.each_ref().map(of);
    Vec3::new(F::load(&all.map(|v| v.x), 0), F::load(&all.map(|v| v.y), 0), F::load(&all.map(|v| v.z), 0))
}

/// The lanes of points that end along u or v.
#[inline(always)]
fn ending<F: Real>(points: &[TextureEvalContext; 8], axis: usize) -> F::Mask {
    let bits = points.iter().enumerate().map(|(lane, point)| u32::from(point.ends[axis]) << lane);
    F::Mask::from_bits(bits.sum())
}

impl SimdKernel for Eight<'_> {
    type Output = [Texel; 8];

    #[inline(always)]
    fn run<L: Level>(self) -> [Texel; 8] {
        let Self { texture, points, wanted } = self;
        let zero = Vec3::zero();
        let at = TextureEvalContext::<L::F64> {
            uv: [numbers(points, |point| point.uv[0]), numbers(points, |point| point.uv[1])],
            ends: [ending::<L::F64>(points, 0), ending::<L::F64>(points, 1)],
            point: vectors(points, |point| point.point),
            error: vectors(points, |point| point.error),
            color: Color::splat(Rgb::ONE),
            footprint: Footprint([vectors(points, |point| point.footprint.0[0]), zero]),
            footprint_uv: Footprint([zero, vectors(points, |point| point.footprint_uv.0[1])]),
            part: L::U32::splat(0),
            objects: [TexturedObject::default(); 8],
        };
        let Texel { color: Color { r, g, b }, alpha } = texture.at(&at, L::Mask::from_bits(wanted));
        let (r, g, b, alpha) = (r.to_array(), g.to_array(), b.to_array(), alpha.to_array());
        std::array::from_fn(|lane| {
            let color = Color { r: r[lane], g: g[lane], b: b[lane] };
            Texel { color, alpha: alpha[lane] }
        })
    }
}

#[test]
fn eight_points_agree_with_single_ones() {
    let mut random = Random(9);
    let odd = [f64::NAN, f64::INFINITY, 1e300, -0.0, 1.0, -3.0];
    for texture in all_kinds() {
        for _ in 0..200 {
            let points: [TextureEvalContext; 8] = std::array::from_fn(|_| {
                let mut number = || 8.0 * random.unit() - 4.0;
                let mut at = context(number(), number(), number());
                at.footprint.0[0] = (DVec3::new(number(), number(), number()) * 0.05).into();
                at.footprint_uv.0[1] = (DVec3::new(number(), number(), 0.0) * 0.05).into();
                at.ends = [(); 2].map(|()| number() < 0.0);
                if number() < -3.0 {
                    at.uv[0] = odd[((number() + 4.0) * 0.75) as usize];
                }
                at
            });
            let wanted = (random.unit() * 256.0) as u32 | 1;
            // Whole pictures show that all levels give the same bytes.
            let all = Eight { texture: &texture, points: &points, wanted }.run::<Portable>();
            for lane in lanes(wanted) {
                let alone = texture.at(&points[lane], true);
                let bits = |texel: Texel| {
                    let Color { r, g, b } = texel.color;
                    [r, g, b, texel.alpha].map(f32::to_bits)
                };
                assert_eq!(bits(all[lane]), bits(alone), "{texture:?}");
            }
        }
    }
}
