//! Annotations as a layer of their own, for EXR files.

use crate::base::color::srgb_to_linear;
use crate::drawing::{Drawing, Layer};

/// The name of the layer.
pub const ANNOTATIONS: &str = "annotations";

/// What a drawing covers.
pub struct AnnotationLayer(Layer);

impl AnnotationLayer {
    /// The layer of a drawing in a picture of this size.
    pub fn new(drawing: &Drawing, size: (u32, u32)) -> Self {
        let mut layer = Layer::new(size);
        drawing.draw(&mut layer);
        Self(layer)
    }

    /// Red, green, blue and alpha of a pixel: linear light premultiplied by alpha, as EXR files hold it. An sRGB
    /// picture with this layer over it, blended as display values, is the annotated picture.
    pub fn linear(&self, pixel: usize) -> [f32; 4] {
        let [r, g, b, alpha] = self.0.pixel(pixel);
        if alpha == 0.0 {
            return [0.0; 4];
        }
        let light = |part: f64| (srgb_to_linear((part / alpha).min(1.0)) * alpha) as f32;
        [light(r), light(g), light(b), alpha as f32]
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
