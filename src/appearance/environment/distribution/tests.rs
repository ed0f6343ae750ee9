//! Distributions of skies: densities, samples, and noise under a bright sun.

use super::*;
use crate::appearance::environment::{CubeMap, Environment};
use crate::appearance::texture::{Image, SharedAsset};
use crate::base::lanes::Color;
use crate::base::math::axis_angle;
use crate::testing::Random;

/// A dim sky with a sun of one texel, and a black lower half.
fn sunny(width: u32, height: u32) -> Sky {
    let sun = (width / 3, height / 4);
    let light = |x, y| match (x, y) {
        at if at == sun => 1000.0,
        (_, y) if y >= height / 2 => 0.0,
        (x, _) => 0.2 + x as f32 / width as f32,
    };
    let texels = (0..height).flat_map(|y| (0..width).map(move |x| Rgb::splat(light(x, y))));
    Sky::Equirect(SharedAsset::new(Image::new(width, height, texels.collect()).expect("an image")))
}

fn faces() -> Sky {
    let face = |light: f32| Image::new(8, 8, vec![Rgb::splat(light); 64]).expect("an image");
    let images = [0.0, 1.0, 20.0, 0.5, 0.0, 3.0].map(face);
    Sky::CubeMap(SharedAsset::new(CubeMap::new(images.each_ref()).expect("a cube map")))
}

fn tables() -> [(Sky, EnvironmentDistribution); 3] {
    [sunny(32, 16), sunny(7, 3), faces()].map(|sky| {
        let table = EnvironmentDistribution::new(&sky).expect("a table");
        (sky, table)
    })
}

#[test]
fn densities_integrate_to_one() {
    for (_, table) in tables() {
        // A uniform grid over the sphere, in height and longitude.
        let (rows, columns) = (1000, 1000);
        let mut sum = 0.0;
        for i in 0..rows * columns {
            let y = (f64::from(i / columns) + 0.5) / f64::from(rows) * 2.0 - 1.0;
            let longitude = (f64::from(i % columns) + 0.5) / f64::from(columns);
            sum += table.pdf(equirect::around(longitude, y, (1.0 - y * y).sqrt()));
        }
        let integral = sum * 2.0 * TAU / f64::from(rows * columns);
        assert!((integral - 1.0).abs() < 0.02, "{integral}");
    }
}

#[test]
fn samples_have_their_density_and_miss_nothing() {
    let mut random = Random(12);
    for (_, table) in tables() {
        for _ in 0..20_000 {
            let (direction, pdf) = table.sample([random.unit(), random.unit()]);
            assert!((direction.length() - 1.0).abs() < 1e-14);
            assert!(pdf > 0.0 && pdf == table.pdf(direction));
            let anywhere = random.direction();
            // Every direction has at least the density of the uniform fraction.
            assert!(table.pdf::<f64>(anywhere.into()) >= 0.999 * UNIFORM_SHARE / (2.0 * TAU));
        }
        for u in [0.0, 1.0f64.next_down()] {
            assert!(DVec3::from(table.sample([u; 2]).0).is_finite());
        }
    }
}

/// At the borders of cells, where a direction may be rounded into the neighbour, samples have the density of the cell that
/// they are drawn from.
#[test]
fn samples_at_borders_have_the_density_of_their_cells() {
    for (_, table) in tables() {
        let width = table.columns.count();
        for row in 0..table.rows.count() {
            let ([v, _], [low, high]) = (table.rows.around(0, row), table.heights.around(0, row));
            let y = 0.5 * (low + high);
            for column in 0..width {
                let [u, _] = table.columns.around(row, column);
                let (_, pdf) = table.sample([u, v]);
                let longitude = (column as f64 + 0.5) / width as f64;
                assert_eq!(
                    pdf,
                    table.pdf(equirect::around(longitude, y, (1.0 - y * y).sqrt())),
                    "{row} {column}"
                );
            }
        }
    }
}

/// Sampled directions fall into cells as often as the densities predict. Pearson's chi-square over all cells is within
/// five standard deviations, √(2k) each, of its mean k.
#[test]
fn samples_follow_the_density() {
    let mut random = Random(21);
    for (_, table) in tables() {
        let count = 400_000;
        let (width, height) = (table.columns.count(), table.rows.count());
        let mut seen = vec![0u32; width * height];
        for _ in 0..count {
            let (direction, _) = table.sample([random.unit(), random.unit()]);
            let column = (equirect::longitude(direction) * width as f64) as usize % width;
            seen[table.heights.find(0, direction.y) * width + column] += 1;
        }
        let (mut square, mut cells) = (0.0, 0.0);
        for (i, &seen) in seen.iter().enumerate() {
            let (row, column) = (i / width, (i % width) as f64 + 0.5);
            let [low, high] = table.heights.around(0, row);
            let y = 0.5 * (low + high);
            let middle = equirect::around(column / width as f64, y, (1.0 - y * y).sqrt());
            let expected = f64::from(count) * table.pdf(middle) * (high - low) * TAU / width as f64;
            if expected >= 5.0 {
                square += (f64::from(seen) - expected) * (f64::from(seen) - expected) / expected;
                cells += 1.0;
            }
        }
        assert!(cells > 10.0 && (square - cells).abs() < 5.0 * (2.0 * cells).sqrt(), "{square} of {cells}");
    }
}

/// The mean of radiance over density is the integral of the sky's radiance, with little noise even under a sun.
#[test]
fn the_sun_is_not_missed() {
    let mut random = Random(30);
    for (sky, table) in tables() {
        let even: f64 =
            (0..400_000).map(|_| f64::from(sky.radiance::<f64>(random.direction().into()).r)).sum();
        let even = even * 2.0 * TAU / 400_000.0;
        let drawn: f64 = (0..20_000)
            .map(|_| {
                let (direction, pdf) = table.sample([random.unit(), random.unit()]);
                f64::from(sky.radiance(direction).r) / pdf
            })
            .sum();
        assert!((drawn / 20_000.0 / even - 1.0).abs() < 0.05, "{} {even}", drawn / 20_000.0);
    }
}

#[test]
fn even_and_black_skies_have_no_table() {
    assert_eq!(EnvironmentDistribution::new(&Sky::Constant(Rgb::ONE)), None);
    assert_eq!(
        EnvironmentDistribution::new(&Sky::Gradient { bottom: Rgb::ONE, top: Rgb::ZERO, up: DVec3::Y }),
        None
    );
    let black = Image::new(2, 1, vec![Rgb::ZERO; 2]).expect("an image");
    assert_eq!(EnvironmentDistribution::new(&Sky::Equirect(SharedAsset::new(black))), None);
}

#[test]
fn a_turned_environment_is_sampled_where_it_is_seen() {
    let (sky, table) = (faces(), EnvironmentDistribution::new(&faces()).expect("a table"));
    let from_world = axis_angle(DVec3::X, Angle(90.0));
    let turned = Environment { sky, from_world, strength: 0.5, ..Environment::default() };
    let mut random = Random(2);
    for _ in 0..1000 {
        let (direction, pdf) = turned.sample(&table, [random.unit(), random.unit()]);
        assert!((turned.pdf(&table, direction) / pdf - 1.0).abs() < 1e-9);
    }
    let up = turned.radiance::<f64>(DVec3::NEG_Z.into());
    assert_eq!(up, Color::grey(10.0), "-z of the world is +y of the sky");
}
