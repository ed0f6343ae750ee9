//! Samplers match their densities, and surfaces reflect no more light than they receive.

use super::{Fuzz, Microfacet, reflect};
use crate::base::lanes::Vec3;
use crate::base::math::{Angle, DVec3};
use crate::testing::{Random, chi_square};

fn at(degrees: f64) -> DVec3 {
    let turn = Angle(degrees).cos_sin();
    DVec3::new(turn.y, 0.0, turn.x)
}

#[test]
fn fuzzy_mirrors_have_their_density() {
    let mut random = Random(11);
    for fuzz in [1.0, 0.6, 0.25] {
        let mirrored = DVec3::new(0.48, 0.6, 0.64);
        let mut draw = || {
            let u = [random.unit(), random.unit(), random.unit()];
            Some(Fuzz(fuzz).sample(mirrored.into(), u).into())
        };
        let p = chi_square(400_000, &mut draw, |d| Fuzz(fuzz).pdf(mirrored.into(), d.into()));
        assert!(p >= 1e-4, "fuzz {fuzz}: {p}");
    }
}

/// The reflection of the eye at a sampled microfacet.
fn mirrored(microfacet: Microfacet<f64>, eye: DVec3, random: &mut Random) -> DVec3 {
    let half = microfacet.sample(eye.into(), random.unit(), random.unit());
    reflect(-Vec3::from(eye), half).into()
}

#[test]
fn small_mirrors_have_their_density() {
    let mut random = Random(12);
    for (alpha, degrees) in [(0.5, 0.0), (0.5, 60.0), (1.0, 80.0), (0.2, 30.0), (0.3, 85.0)] {
        let (microfacet, eye) = (Microfacet { alpha }, at(degrees));
        let draw = || Some(mirrored(microfacet, eye, &mut random)).filter(|light| light.z > 0.0);
        let density = |d: DVec3| if d.z > 0.0 { microfacet.pdf(eye.into(), d.into()) } else { 0.0 };
        let p = chi_square(400_000, draw, density);
        assert!(p >= 1e-4, "alpha {alpha} at {degrees}: {p}");
    }
}

/// The integral over the hemisphere above the surface, by a uniform grid in height and longitude.
fn over_the_hemisphere(f: impl Fn(DVec3) -> f64) -> f64 {
    const SIDE: u32 = 300;
    let cell = |i: u32| (f64::from(i) + 0.5) / f64::from(SIDE);
    let values = (0..SIDE * SIDE).map(|i| {
        let (z, turn) = (cell(i / SIDE), Angle(360.0 * cell(i % SIDE)).cos_sin());
        f((turn * (1.0 - z * z).sqrt()).extend(z))
    });
    values.sum::<f64>() * std::f64::consts::TAU / f64::from(SIDE * SIDE)
}

#[test]
fn rough_surfaces_lose_but_never_gain() {
    let mut random = Random(13);
    for alpha in [0.01, 0.1, 0.5, 1.0] {
        for degrees in [0.0, 45.0, 80.0, 89.0] {
            let (microfacet, eye) = (Microfacet { alpha }, at(degrees));
            let weight = |_| {
                let light = mirrored(microfacet, eye, &mut random);
                if light.z <= 0.0 {
                    return 0.0;
                }
                let pdf = microfacet.pdf(eye.into(), light.into());
                let weight = microfacet.reflected(eye.into(), light.into()) / pdf;
                assert!((0.0..=1.0 + 1e-9).contains(&weight), "{weight}");
                weight
            };
            let mean = (0..20_000).map(weight).sum::<f64>() / 20_000.0;
            // The sampled mean must agree with a sum over a grid, which misses narrow peaks.
            if alpha >= 0.5 {
                let sum = over_the_hemisphere(|light| microfacet.reflected(eye.into(), light.into()));
                assert!((mean - sum).abs() < 0.015, "alpha {alpha} at {degrees}: {mean} against {sum}");
            }
            // In closed form, for normal incidence and alpha 1: ∫ c / (c + 1) dc from 0 to 1.
            if (alpha, degrees) == (1.0, 0.0) {
                let expected = 1.0 - std::f64::consts::LN_2;
                assert!((mean - expected).abs() < 0.01, "{mean} against {expected}");
            }
        }
    }
}

#[test]
fn small_mirrors_are_reciprocal() {
    let mut random = Random(14);
    for _ in 0..1000 {
        let microfacet = Microfacet { alpha: 0.01 + random.unit() };
        let mut above = || {
            let d = random.direction();
            DVec3::new(d.x, d.y, d.z.abs().max(1e-3)).normalize()
        };
        let (a, b) = (above(), above());
        let reflected = |eye: DVec3, light: DVec3| microfacet.reflected(eye.into(), light.into());
        let (there, back) = (reflected(a, b) / b.z, reflected(b, a) / a.z);
        assert!((there / back - 1.0).abs() < 1e-9);
    }
}

#[test]
fn eyes_level_with_a_rough_surface_see_nothing() {
    let light = DVec3::new(-0.6, 0.0, 0.8);
    for eye in [DVec3::X, DVec3::new(0.8, 0.0, -0.6), DVec3::new(1.0, 0.0, 1e-200)] {
        for alpha in [1e-4, 0.5, 1.0] {
            let microfacet = Microfacet { alpha };
            let (eye, light) = (eye.into(), light.into());
            assert_eq!((microfacet.reflected(eye, light), microfacet.pdf(eye, light)), (0.0, 0.0));
        }
    }
}
