//! Weighted layers, AOVs and exposure.

use super::*;

#[test]
fn radiance_weights_the_layers() {
    let mut film = Film::new(2, 1, vec![Rgb::ONE, Rgb::new(0.5, 0.0, 2.0)]);
    film.data_mut()[2..].copy_from_slice(&[Rgb::splat(0.25), Rgb::ONE]);
    assert_eq!(film.radiance().collect::<Vec<_>>(), [Rgb::ZERO, Rgb::new(0.75, 0.25, 2.25)]);
}

#[test]
fn dark_layers_are_ignored() {
    let mut film = Film::new(1, 1, vec![Rgb::ONE, Rgb::ZERO, Rgb::X]);
    assert_eq!((&*film.held, film.data.len()), (&[LayerId(0), LayerId(2)][..], 2));
    film.data_mut().copy_from_slice(&[Rgb::splat(f32::INFINITY), Rgb::splat(0.5)]);
    let fair = film.weighted_by(&[Rgb::ZERO, Rgb::ZERO, Rgb::ONE]);
    assert_eq!(fair.radiance_at(0), Rgb::splat(0.5));
    let parts = |film: &Film| [0, 1, 2].map(|layer| film.radiance_of(0, layer));
    assert_eq!(parts(&fair), [Rgb::ZERO, Rgb::ZERO, Rgb::splat(0.5)]);
    assert!(Arc::ptr_eq(&film.data, &fair.data), "no copy was made");
}

#[test]
fn aovs_follow_the_light() {
    let aovs = AovSet { coverage: true, features: true, ..AovSet::default() };
    let mut film = Film::with_aovs(1, 2, vec![Rgb::ONE; 2], aovs);
    let values = [0.25, 0.5, 0.75].map(Rgb::splat);
    let features = [Rgb::new(3.0, 0.5, 0.0), Rgb::new(0.0, 0.3, 0.4), Rgb::new(0.1, 0.2, 0.3)];
    film.data_mut()[6..].copy_from_slice(&[values.as_slice(), &features].concat());
    assert_eq!(film.radiance().collect::<Vec<_>>(), [Rgb::ZERO, Rgb::splat(0.75)]);
    assert_eq!((film.alpha_at(0), film.alpha_at(1)), (1.0, 0.25));
    assert_eq!(film.radiance_of(1, 1), Rgb::splat(0.5));
    let seen = film.features_at(1).expect("features");
    assert_eq!((seen.depth, seen.albedo), (Some(6.0), Rgb::new(0.1, 0.2, 0.3)));
    assert!((seen.normal - Rgb::new(0.0, 0.6, 0.8)).length() < 1e-6);
    assert_eq!(film.features_at(0).expect("features").depth, None);
    assert_eq!(Film::new(1, 1, vec![Rgb::ONE]).features_at(0), None);
}

#[test]
fn a_stop_doubles_the_exposure() {
    let mut film = Film::new(1, 1, vec![Rgb::ONE]);
    let mut exposed = |stops| {
        film.expose(stops);
        film.exposure
    };
    assert_eq!([0.0, 1.0, -2.0].map(&mut exposed), [1.0, 2.0, 0.25]);
    assert_eq!([40.0, 1e9].map(&mut exposed), [(1u64 << 40) as f32; 2], "no more than 40 stops");
    assert_eq!([-40.0, -1e9].map(&mut exposed), [1.0 / (1u64 << 40) as f32; 2]);
    assert!((exposed(0.5) - 2.0_f32.sqrt()).abs() < 1e-6);
}
