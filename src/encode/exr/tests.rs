//! EXR files are read back by the `exr` crate.

use super::layers::NO_DEPTH;
use super::*;
use crate::encode::settings::ExrLayers;
use crate::film::AovSet;
use exr::prelude::read_first_rgba_layer_from_file;
use std::fs;
use std::sync::Arc;

/// Two layers with values of all kinds. The height is not a multiple of the rows of a block.
fn film() -> Film {
    let mut film = Film::new(5, 37, vec![Rgb::ONE, Rgb::new(0.5, 2.0, 1e-3)]);
    for (i, value) in film.data_mut().iter_mut().enumerate() {
        *value = Rgb::new(i as f32 * 0.37, 1.0 / (i as f32 + 1.0), libm::expf(i as f32 * 0.2));
    }
    film.data_mut()[4] = Rgb::new(-1.0, f32::INFINITY, f32::NAN);
    film
}

#[test]
fn reads_back_the_radiance_to_the_last_bit() {
    let dir = tempfile::tempdir().expect("a folder");
    let path = dir.path().join("a.exr");
    let mut film = film();
    film.expose(3.0);
    write(&path, &film, ExrSettings::default(), (&[], None), &ExrMetadata::default())
        .and_then(|(file, _)| file.commit())
        .expect("written");
    let image = read_first_rgba_layer_from_file(
        path,
        |size, _| vec![Rgb::ZERO; size.area()],
        |pixels, Vec2(x, y), (r, g, b, _): (f32, f32, f32, f32)| pixels[y * 5 + x] = Rgb::new(r, g, b),
    );
    let image = image.expect("an EXR file");
    let bits = |pixels: Vec<Rgb>| pixels.iter().map(|c| c.to_array().map(f32::to_bits)).collect::<Vec<_>>();
    assert_eq!(bits(image.layer_data.channel_data.pixels), bits(film.radiance().collect()));
    assert_eq!(image.attributes.display_window.size, Vec2(5, 37));
    assert_eq!(image.attributes.chromaticities, Some(SRGB));
}

/// Every channel of a file by its name, as f32.
fn channels(path: &Path) -> Vec<(String, Vec<f32>)> {
    let image = exr::prelude::read_first_flat_layer_from_file(path).expect("an EXR file");
    let list = image.layer_data.channel_data.list;
    list.into_iter().map(|c| (c.name.to_string(), c.sample_data.values_as_f32().collect())).collect()
}

#[test]
fn layers_of_light_add_up_and_features_follow() {
    let dir = tempfile::tempdir().expect("a folder");
    let path = dir.path().join("a.exr");
    let aovs = AovSet { coverage: true, features: true, ..AovSet::default() };
    let mut film = Film::with_aovs(3, 2, vec![Rgb::ONE, Rgb::new(0.5, 2.0, 0.0)], aovs);
    for (i, value) in film.data_mut().iter_mut().enumerate() {
        *value = Rgb::new(i as f32, 0.5, 0.25) / 32.0;
    }
    // The first pixel hits nothing.
    film.data_mut()[3..6].fill(Rgb::ZERO);
    film.samples = Some(Arc::new([Rgb::splat(0.25), Rgb::splat(3.0)].repeat(6)));
    let layers = ExrLayers { lights: true, depth: true, normal: true, albedo: true, samples: true };
    let names = ["constant".to_owned(), "key".to_owned()];
    write(
        &path,
        &film,
        ExrSettings { layers, ..ExrSettings::default() },
        (&names, None),
        &ExrMetadata::default(),
    )
    .and_then(|(file, _)| file.commit())
    .expect("written");
    let found = channels(&path);
    let order: Vec<_> = found.iter().map(|(name, _)| name.as_str()).collect();
    let expected = [
        "A",
        "B",
        "G",
        "N.X",
        "N.Y",
        "N.Z",
        "R",
        "Z",
        "albedo.B",
        "albedo.G",
        "albedo.R",
        "constant.B",
        "constant.G",
        "constant.R",
        "key.B",
        "key.G",
        "key.R",
        "samples.B",
        "samples.G",
        "samples.R",
    ];
    assert_eq!(order, expected);
    let value = |name: &str, pixel: usize| {
        found.iter().find(|(found, _)| found == name).map(|(_, values)| values[pixel]).expect(name)
    };
    for pixel in 0..6 {
        for channel in ["R", "G", "B"] {
            let parts = ["constant", "key"].map(|layer| value(&format!("{layer}.{channel}"), pixel));
            assert_eq!(value(channel, pixel), parts[0] + parts[1]);
        }
        assert_eq!(value("A", pixel), film.alpha_at(pixel));
    }
    // The weights of the layers hold for samples, too.
    assert_eq!(["R", "G", "B"].map(|channel| value(&format!("samples.{channel}"), 4)), [1.75, 6.25, 0.25]);
    assert_eq!((value("Z", 0), value("N.X", 0)), (NO_DEPTH, 0.0));
    assert_eq!(Some(value("Z", 1)), film.features_at(1).and_then(|features| features.depth));
}

#[test]
fn values_above_the_half_range_are_clamped() {
    let dir = tempfile::tempdir().expect("a folder");
    let path = dir.path().join("a.exr");
    for (coverage, lights) in [(false, false), (true, false), (false, true)] {
        let aovs = AovSet::of_picture(coverage);
        let mut film = Film::with_aovs(2, 1, vec![Rgb::ONE], aovs);
        film.data_mut()[0] = Rgb::new(65_519.0, 65_520.0, f32::INFINITY);
        let layers = ExrLayers { lights, ..ExrLayers::default() };
        let settings = ExrSettings { half: true, layers, ..ExrSettings::default() };
        let names = ["constant".to_owned()];
        let (file, clipped) =
            write(&path, &film, settings, (&names, None), &ExrMetadata::default()).expect("written");
        file.commit().expect("written");
        assert_eq!(clipped, if lights { 4 } else { 2 });
        for (name, values) in channels(&path) {
            let expected = if name == "A" { film.alpha_at(0) } else { 65_504.0 };
            assert_eq!(values[0], expected, "{name}");
        }
    }
}

#[test]
fn half_floats_have_half_the_precision() {
    let dir = tempfile::tempdir().expect("a folder");
    let path = dir.path().join("a.exr");
    for coverage in [false, true] {
        let aovs = AovSet::of_picture(coverage);
        let mut film = Film::with_aovs(2, 1, vec![Rgb::ONE], aovs);
        film.data_mut()[0] = Rgb::new(0.1, 1.0, 1000.3);
        write(
            &path,
            &film,
            ExrSettings { half: true, ..ExrSettings::default() },
            (&[], None),
            &ExrMetadata::default(),
        )
        .and_then(|(file, _)| file.commit())
        .expect("written");
        let found = channels(&path);
        assert_eq!(found.len(), if coverage { 4 } else { 3 });
        let color: Vec<f32> = found.iter().rev().take(3).map(|(_, values)| values[0]).collect();
        let expected = [0.1, 1.0, 1000.3].map(|value| f16::from_f32(value).to_f32());
        assert_eq!([color[0], color[1], color[2]], expected);
    }
}

#[test]
fn the_bytes_are_always_the_same() {
    let dir = tempfile::tempdir().expect("a folder");
    let bytes = ["a.exr", "b.exr"].map(|name| {
        let path = dir.path().join(name);
        write(&path, &film(), ExrSettings::default(), (&[], None), &ExrMetadata::default())
            .and_then(|(file, _)| file.commit())
            .expect("written");
        fs::read(path).expect("read")
    });
    assert_eq!(bytes[0], bytes[1]);
    // Magic number and version 2, a single part of scan lines.
    assert_eq!(bytes[0][..8], [0x76, 0x2f, 0x31, 0x01, 2, 0, 0, 0]);
}
