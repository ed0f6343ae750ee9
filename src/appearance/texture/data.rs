//! Textures that show numbers of a surface by the colours of a map.

use super::color_map::ColorMap;
use super::{SharedAsset, TextureEvalContext};
use crate::base::color::Rgb;
use crate::base::digest::Content;
use crate::base::lanes::{Color, Mask, Real, Row, lanes};
use crate::geometry::mesh::ArrayKey;

/// Numbers as colours.
#[derive(Clone, Debug, PartialEq, Content)]
pub struct DataTexture {
    pub source: DataSource,
    pub scale: DataScale,
    /// The numbers at the ends of the map, in ascending order. None while unknown, and if there is no number at all.
    pub range: Option<[f64; 2]>,
    /// Whether the range is that of the data.
    pub auto: bool,
    pub map: SharedAsset<ColorMap>,
    /// The colour of points without a number.
    pub missing: Rgb,
}

/// The source of the numbers.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Content)]
pub enum DataSource {
    /// A coordinate in the object's space, before the object is moved: 0, 1 or 2 for x, y or z.
    Coordinate(u32),
    /// A data array of a mesh.
    Array(ArrayKey),
}

/// How numbers are spread over a map.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Content)]
pub enum DataScale {
    #[default]
    Linear,
    /// By their logarithms. Numbers of 0 or less have none.
    Log,
}

impl DataScale {
    /// Whether a number has a place on this scale.
    pub fn has(self, value: f64) -> bool {
        self == Self::Linear || value > 0.0
    }

    /// The place of a number, of which only ratios of differences matter. Halves, because a difference of large numbers
    /// would overflow.
    fn place(self, value: f64) -> f64 {
        match self {
            Self::Linear => 0.5 * value,
            Self::Log => libm::log(value),
        }
    }
}

impl DataScale {
    /// The share of a range that lies below a number: 0 at its low end, 1 at its high end. Of equal numbers, all are
    /// the lowest.
    pub fn share(self, value: f64, range: [f64; 2]) -> f64 {
        let [value, min, max] = [value, range[0], range[1]].map(|value| self.place(value));
        if max > min { (value - min) / (max - min) } else { 0.0 }
    }
}

impl DataTexture {
    /// The colours at points in the lanes `wanted`; black in the others.
    #[inline(always)]
    pub fn at<F: Real>(&self, context: &TextureEvalContext<'_, F>, wanted: F::Mask) -> Color<F::F32> {
        let (points, parts) = (context.point.store(), context.part.to_array());
        let black = F::F32::splat(0.0).to_array();
        let (mut r, mut g, mut b) = (black, black, black);
        for lane in lanes(wanted.bits()) {
            let value = match &self.source {
                DataSource::Coordinate(axis) => Some(points[lane][*axis as usize]),
                DataSource::Array(key) => context.objects[lane].array(key, points[lane], parts[lane]),
            };
            (r[lane], g[lane], b[lane]) = self.color(value.unwrap_or(f64::NAN)).into();
        }
        Color { r: Row::from_array(r), g: Row::from_array(g), b: Row::from_array(b) }
    }

    /// The colour of a number.
    fn color(&self, value: f64) -> Rgb {
        let Some([min, max]) = self.range.filter(|_| !value.is_nan() && self.scale.has(value)) else {
            return self.missing;
        };
        self.map.color(self.scale.share(value.clamp(min, max), [min, max]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::appearance::texture::color_map::NamedMap;

    fn grey(scale: DataScale, min: f64, max: f64) -> impl Fn(f64) -> f32 {
        let map = SharedAsset::new(ColorMap::named(NamedMap::Grey, 256));
        let (source, range) = (DataSource::Coordinate(0), Some([min, max]));
        let texture = DataTexture { source, scale, range, auto: false, map, missing: Rgb::splat(9.0) };
        move |value| {
            let shown = texture.color(value).x;
            (crate::base::color::linear_to_srgb(shown.into()) * 255.0).round() as f32
        }
    }

    #[test]
    fn numbers_are_spread_over_the_range() {
        let linear = grey(DataScale::Linear, -1.0, 3.0);
        let nowhere = f64::NEG_INFINITY;
        assert_eq!([-1.0, 1.0, 3.0, 7.0, nowhere].map(linear), [0.0, 128.0, 255.0, 255.0, 0.0]);
        let log = grey(DataScale::Log, 0.01, 100.0);
        assert_eq!(
            [0.01, 0.1, 1.0, 100.0, 1e-9, f64::INFINITY].map(log),
            [0.0, 64.0, 128.0, 255.0, 0.0, 255.0]
        );
        let wide = grey(DataScale::Linear, -1.5e308, 1.5e308);
        assert_eq!([-1.5e308, 0.0, 1.5e308].map(wide), [0.0, 128.0, 255.0]);
    }

    #[test]
    fn points_without_a_number_stand_out() {
        let missing = grey(DataScale::Linear, 0.0, 1.0)(f64::NAN);
        assert!(missing > 255.0);
        assert_eq!([0.0, -1.0, f64::NAN].map(grey(DataScale::Log, 1.0, 2.0)), [missing; 3]);
        assert_eq!([5.0, 6.0].map(grey(DataScale::Linear, 5.0, 5.0)), [0.0; 2], "of equal numbers");
    }
}
