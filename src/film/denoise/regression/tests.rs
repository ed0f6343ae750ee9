use super::super::columns::LANES;
use super::super::guides::{COUNT, POSITION, guides_of};
use super::super::memory::Memory;
use super::evaluate::ALONG;
use super::*;
use crate::base::color::Rgb;
use crate::base::lanes::{Portable, Row};
use crate::film::{AovSet, Film};
use crate::testing::Random;

/// A film of noise with two layers of light and guides.
fn noise((width, height): (u32, u32)) -> Film {
    let mut random = Random(7);
    let aovs = AovSet { guides: true, ..AovSet::default() };
    let mut film = Film::with_aovs(width, height, vec![Rgb::ONE; 2], aovs);
    for value in film.data_mut() {
        *value = Rgb::from_array([(); 3].map(|()| random.unit() as f32));
    }
    film
}

/// Solves equations whose matrix is positive definite, by elimination.
fn solve(mut matrix: Vec<Vec<f64>>, mut right: Vec<f64>) -> Vec<f64> {
    for pivot in 0..COUNT {
        for row in (0..COUNT).filter(|row| *row != pivot) {
            let factor = matrix[row][pivot] / matrix[pivot][pivot];
            let eliminated = matrix[pivot].clone();
            matrix[row].iter_mut().zip(eliminated).for_each(|(own, other)| *own -= factor * other);
            right[row] -= factor * right[pivot];
        }
    }
    (0..COUNT).map(|row| right[row] / matrix[row][row]).collect()
}

/// A pixel's guides, and its light.
type Pixel = (Vec<f64>, f64);

/// The fit of a window to the guides and light of its pixels, at other guides.
fn fit_directly(pixels: &[Pixel], cell: usize, at: &[f64]) -> f64 {
    let mean = |value: &dyn Fn(&Pixel) -> f64| -> f64 {
        pixels.iter().map(value).sum::<f64>() / pixels.len() as f64
    };
    let guides: Vec<f64> = (0..COUNT).map(|guide| mean(&|(guides, _)| guides[guide])).collect();
    let light = mean(&|(_, light)| *light);
    let covariances = (0..COUNT).map(|row| {
        let covariance = |column: usize| {
            let ridge = if row < POSITION { 1e-4 } else { 1e-4 * (cell * cell) as f64 };
            let own = mean(&|(values, _)| (values[row] - guides[row]) * (values[column] - guides[column]));
            own + if row == column { ridge } else { 0.0 }
        };
        (0..COUNT).map(covariance).collect()
    });
    let products = (0..COUNT).map(|row| mean(&|(values, own)| (values[row] - guides[row]) * (own - light)));
    let slopes = solve(covariances.collect(), products.collect());
    light + (0..COUNT).map(|guide| slopes[guide] * (at[guide] - guides[guide])).sum::<f64>()
}

/// Sums over cells of cells, and lanes, give what every window on its own gives.
#[test]
fn fits_are_least_squares_in_each_window() {
    // Lanes are partly empty, exactly full, and full with more behind them.
    for size in [(37, 21), (16, 70), (1, 3), (128, 5), (150, 40)] {
        let film = noise(size);
        let (width, height) = (size.0 as usize, size.1 as usize);
        let memory = Memory::default();
        let light = Planes::of_film(&memory, &film, 0..2);
        let [guides, _] = Guides::new(light.size(), &guides_of(&memory, &[film.clone(), film.clone()]));
        let mut range = [(); 2].map(|()| light.unset_like(light.count));
        bounds(&light, 0..height, &mut range);
        let [least, most] = range;
        let at = |x: usize, y: usize| -> Vec<f64> {
            let (block, column) = (x / COLUMN / LANES, x / COLUMN % LANES);
            let pixels = guides.pixels(y, block, x % COLUMN);
            let of_pixel = |feature| pixels.get::<<Portable as Level>::F64>(feature).to_array()[column];
            (1..ALONG).map(of_pixel).chain([y as f64]).collect()
        };
        let fitted: [Planes; SCALES] = fit(&guides, &guides, &light);
        let mut random = Random(3);
        for (scale, fitted) in fitted.iter().enumerate() {
            let cell = 2 << scale;
            for plane in 0..light.count {
                let [x, y] = [width, height].map(|length| (random.unit() * length as f64) as usize);
                // The window around the corner at the top left of a cell.
                let window = |column: usize, row: usize| {
                    let reach = |corner: usize, length: usize| {
                        (corner * cell).saturating_sub(cell)..length.min((corner + 1) * cell)
                    };
                    let pixels = reach(row, height).flat_map(|y| reach(column, width).map(move |x| (x, y)));
                    let pixel = |(x, y)| (at(x, y), f64::from(light.row(plane, y)[x]));
                    let pixels: Vec<Pixel> = pixels.map(pixel).collect();
                    fit_directly(&pixels, cell, &at(x, y))
                };
                let [across, down] = [x, y].map(|place| ((place % cell) as f64 + 0.5) / cell as f64);
                let (column, row) = (x / cell, y / cell);
                let above = window(column, row) * (1.0 - across) + window(column + 1, row) * across;
                let below = window(column, row + 1) * (1.0 - across) + window(column + 1, row + 1) * across;
                let direct = (above * (1.0 - down) + below * down) as f32;
                let direct = direct.max(least.row(plane, y)[x]).min(most.row(plane, y)[x]);
                let own = fitted.row(plane, y)[x];
                assert!((own - direct).abs() < 1e-5, "{size:?} {cell} {plane} {x} {y}: {own} {direct}");
            }
        }
    }
}
