//! How much of each pixel a mark covers.

/// The coverage of a rectangle of pixels. Outside of it is none.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CoverageMask {
    /// The place of its top left pixel in the picture, which may be outside.
    pub left: i64,
    pub top: i64,
    pub width: usize,
    pub height: usize,
    /// 0..=1 per pixel, in rows from the top.
    pub values: Vec<f32>,
}

impl CoverageMask {
    /// Adds coverage to a pixel, clamped to 1 because letters may overlap. Pixels outside are left out.
    pub fn add(&mut self, x: i64, y: i64, coverage: f32) {
        let (Ok(x), Ok(y)) = (usize::try_from(x), usize::try_from(y)) else { return };
        if x < self.width && y < self.height {
            let pixel = &mut self.values[y * self.width + x];
            *pixel = (*pixel + coverage).min(1.0);
        }
    }
}
