//! Annotations as a layer of their own, for EXR files.

use crate::base::color::srgb_to_linear;
use crate::drawing::{Canvas, Drawing};

/// The name of the layer.
pub const ANNOTATIONS: &str = "annotations";

/// What a drawing covers: display values premultiplied by alpha, and alpha.
pub struct AnnotationLayer {
    size: (u32, u32),
    pixels: Vec<[f64; 4]>,
}

impl AnnotationLayer {
    /// The layer of a drawing in a picture of this size.
    pub fn new(drawing: &Drawing, size: (u32, u32)) -> Self {
        let mut layer = Self { size, pixels: vec![[0.0; 4]; size.0 as usize * size.1 as usize] };
        drawing.draw(&mut layer);
        layer
    }

    /// Red, green, blue and alpha of a pixel: linear light premultiplied by alpha, as EXR files hold it. An sRGB
    /// picture with this layer over it, blended as display values, is the annotated picture.
    pub fn linear(&self, pixel: usize) -> [f32; 4] {
        let [r, g, b, alpha] = self.pixels[pixel];
        if alpha == 0.0 {
            return [0.0; 4];
        }
        let light = |part: f64| (srgb_to_linear((part / alpha).min(1.0)) * alpha) as f32;
        [light(r), light(g), light(b), alpha as f32]
    }
}

impl Canvas for AnnotationLayer {
    fn size(&self) -> (u32, u32) {
        self.size
    }

    fn blend(&mut self, pixel: usize, [r, g, b]: [f64; 3], opacity: f64) {
        let over = |below: f64, above: f64| above * opacity + below * (1.0 - opacity);
        let [below_r, below_g, below_b, alpha] = self.pixels[pixel];
        self.pixels[pixel] = [over(below_r, r), over(below_g, g), over(below_b, b), over(alpha, 1.0)];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::color::Rgb;
    use crate::base::math::DVec2;
    use crate::drawing::{Ink, Mark};

    #[test]
    fn layers_are_linear_and_premultiplied() {
        let ink = Ink::new(Rgb::new(0.5, 1.0, 0.0), 0.5);
        let mark = Mark::rectangle(DVec2::ZERO, DVec2::new(1.0, 1.0), ink);
        let layer = AnnotationLayer::new(&Drawing { marks: vec![mark] }, (2, 1));
        let [r, g, b, alpha] = layer.linear(0);
        assert!((r - 0.25).abs() < 1e-6 && (g, b, alpha) == (0.5, 0.0, 0.5), "{:?}", layer.linear(0));
        assert_eq!(layer.linear(1), [0.0; 4]);
    }
}
