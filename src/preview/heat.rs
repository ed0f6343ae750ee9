//! Heat maps: the remaining error of each pixel, or its rays.

use crate::appearance::texture::{ColorMap, NamedMap};
use crate::encode::{Picture, ToneTable, Tonemap};

/// What a heat map shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HeatKind {
    /// The estimated error as a share of the mean brightness of the picture.
    Error,
    /// Rays of all kinds for one sample.
    Rays,
}

impl HeatKind {
    pub fn name(self) -> &'static str {
        match self {
            Self::Error => "error",
            Self::Rays => "rays",
        }
    }

    pub fn named(name: &str) -> Option<Self> {
        [Self::Error, Self::Rays].into_iter().find(|kind| kind.name() == name)
    }
}

/// A heat map, and the values at the ends of its colours.
pub struct HeatMap {
    pub picture: Picture,
    pub from: f32,
    pub to: f32,
}

/// Steps of the colours.
const STEPS: u32 = 256;

/// Colours values row by row, dark for the least and bright for the most, by their logarithms. A few outliers do not
/// decide the scale: it ends at the value that one in a thousand exceeds.
pub fn heat_map(values: &[f32], width: u32, height: u32) -> HeatMap {
    let mut sorted: Vec<f32> = values.iter().copied().filter(|value| *value > 0.0).collect();
    sorted.sort_unstable_by(f32::total_cmp);
    let at = |share: usize| sorted.get((sorted.len().saturating_sub(1)) * share / 1000).copied();
    let (from, to) = (at(10).unwrap_or(0.0), at(999).unwrap_or(0.0));
    let (low, span) = (libm::logf(from.max(f32::MIN_POSITIVE)), {
        let ratio = to.max(f32::MIN_POSITIVE) / from.max(f32::MIN_POSITIVE);
        libm::logf(ratio)
    });
    let (map, table) = (ColorMap::named(NamedMap::Inferno, STEPS), ToneTable::new(Tonemap::Srgb));
    let shade = |value: f32| -> f64 {
        if value <= 0.0 {
            return 0.0;
        }
        let share = if span > 0.0 { (libm::logf(value) - low) / span } else { 0.5 };
        f64::from(share.clamp(0.0, 1.0))
    };
    let rgb =
        values.iter().flat_map(|value| map.color(shade(*value)).to_array().map(|part| table.code(part)));
    HeatMap { picture: Picture::opaque(width, height, rgb.collect()), from, to }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn more_is_brighter() {
        let values: Vec<f32> = (0..64_u8).map(|index| libm::expf(0.1 * f32::from(index))).collect();
        let map = heat_map(&values, 8, 8);
        let sums: Vec<u32> = map
            .picture
            .rgb
            .as_chunks::<3>()
            .0
            .iter()
            .map(|c| c.iter().map(|c| u32::from(*c)).sum())
            .collect();
        assert!(sums.is_sorted() && sums[0] < 20 && sums[63] > 500, "{sums:?}");
        assert!(map.from < map.to);
        // Without any value, all is the darkest colour.
        let nothing = heat_map(&[0.0; 4], 2, 2).picture.rgb;
        assert!(nothing.chunks(3).all(|color| color == &nothing[..3] && color.iter().all(|code| *code < 8)));
    }
}
