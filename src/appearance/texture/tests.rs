//! Textures at a moment and over time.

use super::*;
use crate::base::color::Rgb;
use crate::base::math::{DVec2, DVec3};
use crate::base::time::Time;
use crate::track::{Animated, Ease, Key, Repeat, Track};

fn context(x: f64, y: f64, z: f64) -> TextureEvalContext<'static> {
    let (uv, point) = (DVec2::new(x, y), DVec3::new(x, y, z));
    TextureEvalContext {
        uv,
        point,
        error: DVec3::splat(1e-14),
        color: Rgb::ONE,
        ..TextureEvalContext::default()
    }
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
    assert_eq!(texture.at(&context(0.75, 0.25, -1.0)).color, Rgb::X, "a stripe");
    assert_eq!(texture.at(&context(1.25, 0.25, -1.0)).color, Rgb::Y, "a stripe");
    assert_eq!(texture.at(&context(0.75, 0.25, 1.0)).color, Rgb::ONE, "the image");
    assert_eq!(texture.at(&context(0.25, 0.75, 0.25)).color, Rgb::X, "both are red here");
    assert_eq!(texture.at(&context(1.25, 0.25, 0.5)).color, Rgb::new(0.0, 0.5, 0.5), "half of each");
    assert!(texture.constant().is_none());
}

#[test]
fn offset_keys_slide_a_texture() {
    let key = |time: i128, value| Key { time: Time::from_integer(time), value, ease: Ease::Linear };
    let keys = vec![key(0, DVec3::ZERO), key(1, DVec3::X)];
    let offset = Track::new(keys, Repeat::Hold, false).expect("a track");
    let mut tracks = image();
    tracks.mapping.offset = Animated::Keyed(offset);
    let seen = |num| tracks.at(Time::new(num, 2)).at(&context(0.25, 0.25, 0.0)).color;
    assert_eq!([0, 1, 2].map(seen), [Rgb::Z, Rgb::ONE, Rgb::Z], "the image moves to the right");
}

#[test]
fn one_channel_is_grey() {
    let mut tracks = image();
    tracks.channel = Some(ColorChannel::G);
    let texture = TextureTracks::Image(Box::new(tracks)).at(start());
    assert_eq!(texture.at(&context(0.75, 0.75, 0.0)).color, Rgb::ONE);
    assert_eq!(texture.at(&context(0.25, 0.75, 0.0)).color, Rgb::ZERO);
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
    let checker = checker.at(start());
    for k in 0..10u32 {
        let v = f64::from(k) * 0.1;
        let colors = [v - 1e-14, v, v + 1e-14].map(|v| checker.at(&context(0.05, v, 0.0)).color);
        assert_eq!(colors, [[Rgb::X, Rgb::Y][k as usize % 2]; 3]);
    }
}

#[test]
fn a_color_is_constant_and_vertex_colors_are_not() {
    assert_eq!(TextureTracks::from(Rgb::X).at(start()).constant(), Some(Rgb::X));
    let vertex = TextureTracks::VertexColor.at(start());
    assert!(vertex.constant().is_none());
    assert_eq!(vertex.at(&TextureEvalContext { color: Rgb::Z, ..context(0.0, 0.0, 0.0) }).color, Rgb::Z);
}
