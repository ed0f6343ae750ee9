//! Codes compared with the formula, and films with extreme values.

use super::*;
use crate::base::color::srgb_to_linear;
use crate::film::AovSet;

/// The tone maps with different curves.
const CURVES: [Tonemap; 3] = [Tonemap::Srgb, Tonemap::None, Tonemap::Filmic];

#[test]
fn equals_the_formula_around_every_threshold() {
    for tonemap in CURVES {
        let table = ToneTable::new(tonemap);
        for code in 1..=255 {
            let t = threshold(tonemap, code);
            for x in [t.next_down(), t, t.next_up()] {
                assert_eq!(u32::from(table.code(x)), exact_code(tonemap, x), "{tonemap:?} {code} {x}");
            }
            assert_eq!(u32::from(table.code(t)), code);
            assert_eq!(u32::from(table.code(t.next_down())), code - 1);
        }
    }
}

#[test]
fn co_01_equals_the_formula_and_is_monotone_over_65536_values() {
    for tonemap in CURVES {
        let table = ToneTable::new(tonemap);
        let mut last = 0;
        for i in 0..=65_536u32 {
            let x = i as f32 / 65_536.0 * 8.0;
            let code = table.code(x);
            assert_eq!(u32::from(code), exact_code(tonemap, x), "{tonemap:?} {x}");
            assert!(code >= last);
            last = code;
        }
    }
}

#[test]
fn no_step_holds_two_thresholds() {
    for tonemap in CURVES {
        let step = |code| (threshold(tonemap, code).to_bits() - LOWEST.to_bits()) >> STEP_BITS;
        assert!((1..255).all(|code| step(code) < step(code + 1)), "{tonemap:?}");
    }
}

#[test]
fn co_01_known_codes() {
    let table = ToneTable::new(Tonemap::Srgb);
    let codes = [0.0, 0.001, 0.003_130_8, 0.18, 0.5, 1.0].map(|x| table.code(x));
    assert_eq!(codes, [0, 3, 10, 118, 188, 255]);
    for code in 0..=255u8 {
        assert_eq!(table.code(srgb_to_linear(f64::from(code) / 255.0) as f32), code);
    }
}

#[test]
fn co_02_values_outside_the_range() {
    let mut film = Film::new(3, 2, vec![Rgb::ONE]);
    let values = [f32::NAN, -0.1, f32::INFINITY, 1e30, -f32::INFINITY, HIGHEST];
    for (pixel, value) in film.data_mut().iter_mut().zip(values) {
        pixel.x = value;
    }
    for (name, tonemap) in Tonemap::NAMED {
        let (picture, nan_pixels) = ToneTable::new(tonemap).develop(&film);
        let red: Vec<u8> = picture.rgb.chunks(3).map(|pixel| pixel[0]).collect();
        assert_eq!(red, [0, 0, 255, 255, 0, 255], "{name}");
        assert_eq!(nan_pixels, 1);
    }
}

#[test]
fn co_02_halves_round_up_and_one_is_white() {
    let half_up = srgb_to_linear(254.5 / 255.0) as f32;
    assert_eq!(exact_code(Tonemap::Srgb, half_up), 255);
    assert_eq!(ToneTable::new(Tonemap::Srgb).code(half_up), 255);
    assert_eq!(ToneTable::new(Tonemap::None).code(127.5 / 255.0), 128);
    for tonemap in [Tonemap::Srgb, Tonemap::None] {
        assert_eq!([1.0, 1.0_f32.next_up()].map(|x| ToneTable::new(tonemap).code(x)), [255; 2]);
    }
}

#[test]
fn exposure_is_applied_before_the_tone_map() {
    let mut film = Film::new(1, 1, vec![Rgb::splat(0.5)]);
    film.data_mut()[0] = Rgb::new(0.25, 0.5, 1.0);
    film.expose(2.0);
    for (name, tonemap) in Tonemap::NAMED {
        let mut brighter = Film::new(1, 1, vec![Rgb::ONE]);
        brighter.data_mut()[0] = Rgb::new(0.5, 1.0, 2.0);
        let table = ToneTable::new(tonemap);
        assert_eq!(table.develop(&film), table.develop(&brighter), "{name}");
    }
}

#[test]
fn reinhard_compresses_the_luminance() {
    let mut film = Film::new(2, 1, vec![Rgb::ONE]);
    film.data_mut().copy_from_slice(&[Rgb::ONE, Rgb::X]);
    let (picture, _) = ToneTable::new(Tonemap::Reinhard).develop(&film);
    let code = |linear: f32| exact_code(Tonemap::Srgb, linear) as u8;
    assert_eq!(picture.rgb, [code(0.5), code(0.5), code(0.5), code(1.0 / 1.2126), 0, 0]);
}

#[test]
fn sixteen_bits_hold_the_same_picture_more_finely() {
    let mut film = Film::new(64, 4, vec![Rgb::ONE]);
    for (i, pixel) in film.data_mut().iter_mut().enumerate() {
        *pixel = Rgb::new(i as f32 / 200.0, i as f32 * 0.02, -1.0);
    }
    film.data_mut()[9].x = f32::NAN;
    for (name, tonemap) in Tonemap::NAMED {
        let (picture, _) = ToneTable::new(tonemap).develop(&film);
        let deep = develop_deep(tonemap, &film);
        let near =
            |(code, deep): (&u8, &u16)| (f64::from(*code) - f64::from(*deep) / 257.0).abs() <= 0.5 + 1e-9;
        assert!(picture.rgb.iter().zip(&deep.rgb).all(near), "{name}");
        assert!(deep.rgb.iter().any(|deep| deep % 257 != 0), "{name}");
    }
}

/// A pixel with a quarter of coverage has the full colour and an alpha of a quarter.
#[test]
fn colours_are_not_premultiplied() {
    let aovs = AovSet::of_picture(true);
    let mut film = Film::with_aovs(3, 1, vec![Rgb::ONE], aovs);
    let color = Rgb::new(0.18, 0.5, 1.0);
    film.data =
        std::sync::Arc::new(vec![color, Rgb::ZERO, color * 0.25, Rgb::splat(0.75), Rgb::ZERO, Rgb::ONE]);
    let (picture, _) = ToneTable::new(Tonemap::Srgb).develop(&film);
    assert_eq!(picture.rgb, [118, 188, 255, 118, 188, 255, 0, 0, 0]);
    assert_eq!(picture.alpha, Some(vec![255, 64, 0]));
    let deep = develop_deep(Tonemap::Srgb, &film);
    assert_eq!(deep.rgb[..3], deep.rgb[3..6]);
    assert_eq!(deep.alpha, Some(vec![65535, 16384, 0]));
}
