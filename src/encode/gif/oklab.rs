//! Oklab, a perceptually uniform colour space (Ottosson, <https://bottosson.github.io/posts/oklab/>).

use crate::base::color::{linear_to_srgb, srgb_to_linear};

/// From linear sRGB to cone responses.
pub const RGB_TO_LMS: [[f32; 3]; 3] = [
    [0.412_221_47, 0.536_332_54, 0.051_445_993],
    [0.211_903_5, 0.680_699_5, 0.107_396_96],
    [0.088_302_46, 0.281_718_84, 0.629_978_7],
];
/// From the cube roots of cone responses to Oklab.
pub const LMS_ROOT_TO_OKLAB: [[f32; 3]; 3] = [
    [0.210_454_26, 0.793_617_8, -0.004_072_047],
    [1.977_998_5, -2.428_592_2, 0.450_593_7],
    [0.025_904_037, 0.782_771_77, -0.808_675_77],
];
/// The inverses of the matrices above.
const OKLAB_TO_LMS_ROOT: [[f32; 3]; 3] = [
    [1.0, 0.396_337_78, 0.215_803_76],
    [1.0, -0.105_561_346, -0.063_854_17],
    [1.0, -0.089_484_18, -1.291_485_5],
];
const LMS_TO_RGB: [[f32; 3]; 3] = [
    [4.076_741_7, -3.307_711_6, 0.230_969_94],
    [-1.268_438, 2.609_757_4, -0.341_319_38],
    [-0.004_196_086_3, -0.703_418_6, 1.707_614_7],
];

/// A colour in Oklab: lightness, and the axes from green to red and from blue to yellow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Oklab {
    pub l: f32,
    pub a: f32,
    pub b: f32,
}

pub fn multiply(matrix: &[[f32; 3]; 3], v: [f32; 3]) -> [f32; 3] {
    matrix.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

/// The linear value of an sRGB code, which may be fractional.
pub fn linear_of_code(code: f32) -> f32 {
    srgb_to_linear(f64::from(code) / 255.0) as f32
}

/// Oklab of a linear sRGB colour.
pub fn oklab(linear: [f32; 3]) -> Oklab {
    let [l, a, b] = multiply(&LMS_ROOT_TO_OKLAB, multiply(&RGB_TO_LMS, linear).map(libm::cbrtf));
    Oklab { l, a, b }
}

/// The sRGB codes nearest to a colour in Oklab.
pub fn code_of_oklab(lab: [f32; 3]) -> [u8; 3] {
    let linear = multiply(&LMS_TO_RGB, multiply(&OKLAB_TO_LMS_ROOT, lab).map(|root| root * root * root));
    linear.map(|part| (linear_to_srgb(f64::from(part).clamp(0.0, 1.0)) * 255.0 + 0.5) as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_survive_oklab() {
        for code in [[0, 0, 0], [255, 255, 255], [255, 0, 0], [3, 200, 90], [17, 17, 255]] {
            let Oklab { l, a, b } = oklab(code.map(|code| linear_of_code(f32::from(code))));
            assert_eq!(code_of_oklab([l, a, b]), code);
        }
    }

    #[test]
    fn oklab_of_known_colors() {
        let white = oklab([1.0; 3]);
        assert!((white.l - 1.0).abs() < 1e-5 && white.a.abs() < 1e-5 && white.b.abs() < 1e-5);
        let red = oklab([1.0, 0.0, 0.0]);
        assert!((red.l - 0.62796).abs() < 1e-4 && (red.a - 0.22486).abs() < 1e-4);
    }
}
