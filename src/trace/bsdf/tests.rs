//! Light on surfaces: where there is a highlight, and where there is not.

use super::*;
use crate::appearance::material::{Coat, Exponent, Highlight, Lobes, Material, Medium};
use crate::appearance::optics::Fresnel;
use crate::base::color::Rgb;
use crate::base::math::DVec3;
use crate::film::LayerId;

fn material(highlight: Highlight, shininess: f64) -> Material {
    Material {
        lobes: Lobes { specular: Rgb::ONE, ..Lobes::default() },
        textures: Vec::new(),
        emission_layer: LayerId::CONSTANT,
        highlight,
        shininess: Exponent::new(shininess),
        fresnel: Fresnel::Off,
        medium: Medium::EMPTY,
        relief: Default::default(),
    }
}

/// The reflection of a level surface to the eye: diffuse, glossy, and the highlight.
fn reflected(material: &Material, to_light: DVec3, to_eye: DVec3) -> [Rgb; 3] {
    with_bsdf(material, to_eye, |bsdf| {
        let Reflected { diffuse, glossy, highlight } = bsdf.reflected(to_light.into());
        [diffuse, glossy, highlight].map(Rgb::from)
    })
}

/// Calls `use_it` with the lobes of a level surface.
fn with_bsdf<R>(material: &Material, to_eye: DVec3, use_it: impl FnOnce(&Bsdf<f64>) -> R) -> R {
    let surface = LaneSurface::<f64>::new(Vec3::zero(), Vec3::zero(), DVec3::Y.into());
    let table = LobeTable::new([&material.lobes].into_iter());
    let lobes = LobeSet::of(material);
    let shininess = Shininess::gather(|_| material.shininess);
    let eye = FrameAxes::from_z_near_x(to_eye.into(), [DVec3::X, DVec3::Y]);
    let rows = (&table, &Lookup::run(0, 1));
    let mut bsdf = Bsdf::gather(lobes, rows, shininess, material.medium.ior, (&surface, &eye, true));
    bsdf.cover(rows.0, rows.1);
    use_it(&bsdf)
}

#[test]
fn sh_01_the_half_vector_lies_between_light_and_eye() {
    // Eye and light mirror each other about the normal. So this is the centre of the highlight, wherever they are.
    for shift in [DVec3::ZERO, DVec3::new(1024.0, -512.0, 256.0)] {
        let point = DVec3::new(10.0, 0.0, 0.0) + shift;
        let to_light = (DVec3::new(13.0, 4.0, 0.0) + shift - point).normalize();
        let to_eye = (DVec3::new(7.0, 4.0, 0.0) + shift - point).normalize();
        for model in [Highlight::Phong, Highlight::BlinnPhong] {
            let [diffuse, glossy, highlight] = reflected(&material(model, 32.0), to_light, to_eye);
            assert_eq!((diffuse, glossy), (Rgb::ZERO, Rgb::ZERO));
            assert!((highlight - Rgb::ONE).abs().max_element() <= f32::EPSILON, "{highlight}");
        }
    }
}

/// Corner cases of the highlight, in which a power alone gives light that should not exist, or NaN.
#[test]
fn sh_02_no_highlight_without_light_on_the_surface() {
    let eye = DVec3::new(-1.0, 0.0, 0.0);
    let (grazing, below) = (DVec3::X, DVec3::new(0.8, -0.6, 0.0));
    for model in [Highlight::Phong, Highlight::BlinnPhong] {
        for shininess in [0.0, 1.0, 0.5, 1e6] {
            for light in [grazing, below, DVec3::NEG_Y] {
                let found = reflected(&material(model, shininess), light, eye);
                assert_eq!(found, [Rgb::ZERO; 3], "{model:?} {shininess} {light}");
            }
        }
    }
    // The light is above the surface, but its mirror image is at or beyond a right angle to the eye.
    let light = DVec3::new(0.6, 0.8, 0.0);
    for eye in [DVec3::new(0.8, 0.6, 0.0), DVec3::new(0.96, 0.28, 0.0)] {
        for shininess in [0.0, 0.5, 1.0, 1e6] {
            let found = reflected(&material(Highlight::Phong, shininess), light, eye);
            assert_eq!(found, [Rgb::ZERO; 3], "{shininess} {eye}");
        }
    }
}

#[test]
fn diffuse_follows_the_cosine() {
    let lobes = Lobes { diffuse: Rgb::splat(0.5), ..Lobes::default() };
    let matte = Material { lobes, ..material(Highlight::Phong, 1.0) };
    let at_60 = DVec3::new(0.75f64.sqrt(), 0.5, 0.0);
    assert_eq!(reflected(&matte, at_60, DVec3::Y), [Rgb::splat(0.25), Rgb::ZERO, Rgb::ZERO]);
}

/// A coat of varnish over a white surface.
fn coated(share: f32, roughness: f32) -> Material {
    let lobes = Lobes { diffuse: Rgb::ONE, coat: Coat { share, roughness, hole: 0.0 }, ..Lobes::default() };
    Material { lobes, ..material(Highlight::Phong, 1.0) }
}

/// Directions to the eye, from the normal almost to the horizon.
fn eyes() -> impl Iterator<Item = DVec3> {
    [1.0, 0.7, 0.3, 0.05].into_iter().map(|y: f64| DVec3::new((1.0 - y * y).sqrt(), y, 0.0))
}

/// The light that samples give below a sky of radiance 1.
fn sampled(material: &Material, to_eye: DVec3) -> f64 {
    const SIDE: u32 = 24;
    let number = |index: u32| (f64::from(index) + 0.5) / f64::from(SIDE);
    with_bsdf(material, to_eye, |bsdf| {
        let boundary = Boundary { eta: 1.0 };
        let mut sum = 0.0;
        for (u, v, choice) in (0..SIDE.pow(3)).map(|i| (i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE)) {
            let sample = bsdf.sample(&boundary, [number(u), number(v), number(choice), 0.5]);
            if sample.continues() {
                sum += f64::from(sample.diffuse.r + sample.specular.r);
            }
        }
        sum / f64::from(SIDE.pow(3))
    })
}

/// What a sharp coat reflects is taken from the surface below, so a white surface under a white sky stays white.
#[test]
fn sharp_coats_keep_all_light() {
    for (coat, eye) in [0.25, 1.0].into_iter().flat_map(|coat| eyes().map(move |eye| (coat, eye))) {
        let light = sampled(&coated(coat, 0.0), eye);
        // Every sample has the weight 1, up to the roundings of f32 to both sides of it.
        assert!((light - 1.0).abs() < 2.0 * f64::from(f32::EPSILON), "{coat} {eye} {light}");
    }
}

/// Samples of a rough coat give the light that the sum of all directions gives, and no more than falls in.
#[test]
fn samples_of_rough_coats_agree_with_their_shares() {
    // Cells of equal solid angle over half of the hemisphere, narrow enough for reflections near the horizon.
    const STEPS: [u32; 2] = [200, 1000];
    for (roughness, eye) in [0.3, 0.8].into_iter().flat_map(|rough| eyes().map(move |eye| (rough, eye))) {
        let material = coated(1.0, roughness);
        let mut sum = 0.0;
        for (i, j) in (0..STEPS[0]).flat_map(|i| (0..STEPS[1]).map(move |j| (i, j))) {
            let [y, turn] =
                [(i, STEPS[0]), (j, STEPS[1])].map(|(at, of)| (f64::from(at) + 0.5) / f64::from(of));
            let (sin, cos) = libm::sincos(std::f64::consts::PI * turn);
            let flat = (1.0 - y * y).sqrt();
            let [diffuse, glossy, _] = reflected(&material, DVec3::new(flat * cos, y, flat * sin), eye);
            sum += f64::from(diffuse.x + glossy.x);
        }
        // Shares are π times what counts, over 2 π steradians.
        let (all, light) = (2.0 * sum / f64::from(STEPS[0] * STEPS[1]), sampled(&material, eye));
        // Both sums have finite steps: the differences are 0.002 near the horizon, and below 0.001 elsewhere.
        assert!((all - light).abs() < 0.003, "{roughness} {eye} {all} {light}");
        assert!(light < 1.001, "{roughness} {eye} {light}");
    }
}
