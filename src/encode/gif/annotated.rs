//! Annotations in GIFs: their colours are in the palette, and their pixels are not dithered.

use crate::drawing::{Canvas, Drawing};
use std::collections::BTreeSet;
use std::sync::Arc;

/// The part of the palette that annotations may reserve.
const RESERVED: usize = 4;

/// The colours that the palette keeps for drawings: at most a quarter of its `size`. Solid colours come first; of the
/// steps of colour bars, the palette has as many as there is room for, evenly chosen.
pub fn reserved_colors<'d>(drawings: impl Iterator<Item = &'d Arc<Drawing>>, size: usize) -> Vec<[u8; 3]> {
    let (mut solid, mut steps) = (BTreeSet::new(), BTreeSet::new());
    let mut last: Option<&Arc<Drawing>> = None;
    for drawing in drawings {
        // Frames with equal drawings share them.
        if !last.is_some_and(|last| Arc::ptr_eq(last, drawing)) {
            solid.extend(drawing.solid_colors());
            steps.extend(drawing.step_colors());
        }
        last = Some(drawing);
    }
    let most = size / RESERVED;
    let mut kept: Vec<[u8; 3]> = solid.into_iter().take(most).collect();
    let steps: Vec<[u8; 3]> = steps.into_iter().filter(|color| !kept.contains(color)).collect();
    let room = (most - kept.len()).min(steps.len());
    kept.extend((0..room).map(|index| steps[index * steps.len() / room]));
    kept
}

/// The pixels that a drawing covers.
pub struct CoveredPixels {
    size: (u32, u32),
    covered: Vec<bool>,
}

impl CoveredPixels {
    /// None if it covers nothing.
    pub fn of(drawing: &Drawing, size: (u32, u32)) -> Option<Vec<bool>> {
        if drawing.is_empty() {
            return None;
        }
        let mut pixels = Self { size, covered: vec![false; size.0 as usize * size.1 as usize] };
        drawing.draw(&mut pixels);
        Some(pixels.covered)
    }
}

impl Canvas for CoveredPixels {
    fn size(&self) -> (u32, u32) {
        self.size
    }

    fn blend(&mut self, pixel: usize, _: [f64; 3], _: f64) {
        self.covered[pixel] = true;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::color::Rgb;
    use crate::base::math::DVec2;
    use crate::drawing::{Ink, Mark};

    #[test]
    fn solid_colors_come_before_steps() {
        let ink = Ink::new(Rgb::X, 1.0);
        let grey = |step: u32| [f64::from(step) / 255.0; 3];
        let bar = Mark::Steps {
            place: [0, 0, 9, 9],
            colors: (0..256).map(grey).collect(),
            upwards: true,
            opacity: 1.0,
        };
        let drawing = Drawing { marks: vec![bar, Mark::rectangle(DVec2::ZERO, DVec2::ONE, ink)] };
        let kept = reserved_colors([Arc::new(drawing)].iter(), 64);
        assert_eq!((kept.len(), kept[0], kept[1]), (16, [255, 0, 0], [0; 3]));
        assert!(kept.windows(2).skip(1).all(|pair| pair[1][0] - pair[0][0] <= 18));
    }
}
