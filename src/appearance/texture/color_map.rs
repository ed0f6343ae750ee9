//! Colour maps: colours for numbers from 0 to 1.

mod tables;

use crate::base::color::{Rgb, linear_to_srgb, srgb_to_linear};
use crate::base::digest::Content;

/// A named colour map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NamedMap {
    Viridis,
    Magma,
    Inferno,
    Plasma,
    Cividis,
    Turbo,
    Coolwarm,
    Grey,
}

/// The steps of a map that has no stated number of steps. 8-bit pictures show no more.
pub const DEFAULT_STEPS: u32 = 256;

/// The linear colours of equal steps from 0 to 1, at least one.
///
/// A number t in 0..=1 has the colour of step floor(n t) of n, as in matplotlib, VTK and d3. So a map is a table for all
/// of them, and their colours for the same number are equal.
#[derive(Clone, Debug, PartialEq, Content)]
pub struct ColorMap {
    colors: Vec<Rgb>,
}

impl ColorMap {
    /// The colours of a named map at `steps` equally spaced numbers, 0 and 1 included.
    pub fn named(map: NamedMap, steps: u32) -> Self {
        let table = match map {
            NamedMap::Viridis => &tables::VIRIDIS,
            NamedMap::Magma => &tables::MAGMA,
            NamedMap::Inferno => &tables::INFERNO,
            NamedMap::Plasma => &tables::PLASMA,
            NamedMap::Cividis => &tables::CIVIDIS,
            NamedMap::Turbo => &tables::TURBO,
            NamedMap::Coolwarm => &tables::COOLWARM,
            NamedMap::Grey => return Self::between(&[Rgb::ZERO, Rgb::ONE], steps),
        };
        let color = |code: u32| {
            let part = |shift: u32| srgb_to_linear(f64::from(code >> shift & 0xff) / 255.0) as f32;
            Rgb::new(part(16), part(8), part(0))
        };
        let whole = Self { colors: table.map(color).to_vec() };
        Self { colors: numbers(steps).map(|t| whole.color(t)).collect() }
    }

    /// A map through a list of two or more linear colours at equal distances. Their sRGB values are interpolated, as on
    /// a screen.
    pub fn between(list: &[Rgb], steps: u32) -> Self {
        let parts = list.len().saturating_sub(1);
        let color = |t: f64| {
            let at = t * parts as f64;
            let low = (at as usize).min(parts.saturating_sub(1));
            let mixed = |a: f32, b: f32| {
                let [a, b] = [a, b].map(|part| linear_to_srgb(part.into()));
                srgb_to_linear(a + (b - a) * (at - low as f64)) as f32
            };
            let mix = |[a, b]: &[Rgb; 2]| Rgb::new(mixed(a.x, b.x), mixed(a.y, b.y), mixed(a.z, b.z));
            list.array_windows().nth(low).map_or(Rgb::ZERO, mix)
        };
        Self { colors: numbers(steps).map(color).collect() }
    }

    /// The colours of the steps, from 0 to 1.
    pub fn steps(&self) -> &[Rgb] {
        &self.colors
    }

    /// The same map from the other end.
    pub fn reversed(mut self) -> Self {
        self.colors.reverse();
        self
    }

    /// The colour of a number. Numbers outside of 0..=1 have the colours of the ends.
    pub fn color(&self, t: f64) -> Rgb {
        // Casts clamp at 0.
        let step = ((t * self.colors.len() as f64) as usize).min(self.colors.len() - 1);
        self.colors[step]
    }
}

/// `steps` equally spaced numbers, at least one, from 0 to 1.
fn numbers(steps: u32) -> impl Iterator<Item = f64> {
    let last = f64::from(steps.saturating_sub(1).max(1));
    (0..steps.max(1)).map(move |step| f64::from(step) / last)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn code(color: Rgb) -> [u8; 3] {
        color.to_array().map(|part| (linear_to_srgb(part.into()) * 255.0 + 0.5) as u8)
    }

    /// First, middle and last colours as published.
    #[test]
    fn named_maps_have_their_colors() {
        for (map, [first, middle, last]) in [
            (NamedMap::Viridis, [[68, 1, 84], [33, 145, 140], [253, 231, 37]]),
            (NamedMap::Magma, [[0, 0, 4], [183, 55, 121], [252, 253, 191]]),
            (NamedMap::Inferno, [[0, 0, 4], [188, 55, 84], [252, 255, 164]]),
            (NamedMap::Plasma, [[13, 8, 135], [204, 71, 120], [240, 249, 33]]),
            (NamedMap::Cividis, [[0, 34, 78], [125, 124, 120], [254, 232, 56]]),
            (NamedMap::Turbo, [[48, 18, 59], [164, 252, 60], [122, 4, 3]]),
            (NamedMap::Coolwarm, [[59, 76, 192], [221, 220, 220], [180, 4, 38]]),
            (NamedMap::Grey, [[0, 0, 0], [128, 128, 128], [255, 255, 255]]),
        ] {
            let map = ColorMap::named(map, DEFAULT_STEPS);
            assert_eq!([-1.0, 0.5, 2.0].map(|t| code(map.color(t))), [first, middle, last]);
        }
    }

    #[test]
    fn steps_are_equal_and_show_both_ends() {
        let map = ColorMap::named(NamedMap::Grey, 3);
        let grey = [0.0, 0.33, 0.34, 0.66, 0.67, 1.0].map(|t| code(map.color(t))[0]);
        assert_eq!(grey, [0, 0, 128, 128, 255, 255]);
        assert_eq!(code(map.reversed().color(0.0))[0], 255);
        let viridis = ColorMap::named(NamedMap::Viridis, 2);
        assert_eq!([0.49, 0.5].map(|t| code(viridis.color(t))), [[68, 1, 84], [253, 231, 37]]);
    }

    #[test]
    fn lists_are_mixed_as_on_a_screen() {
        let colors = [Rgb::ZERO, Rgb::X, Rgb::ONE];
        let map = ColorMap::between(&colors, 5);
        let seen = [0.0, 0.2, 0.4, 0.6, 1.0].map(|t| code(map.color(t)));
        assert_eq!(seen, [[0, 0, 0], [128, 0, 0], [255, 0, 0], [255, 128, 128], [255, 255, 255]]);
    }
}
