//! Conversion to Y'CbCr by the matrix of Rec. 709, in the limited range (black is 16 and white is 235).

use crate::encode::picture::Picture;

/// Three planes of codes: luma and two chroma planes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Planes {
    pub width: usize,
    pub height: usize,
    /// Width and height of the chroma planes.
    pub chroma: (usize, usize),
    pub y: Vec<u8>,
    pub u: Vec<u8>,
    pub v: Vec<u8>,
}

/// Weights of red, green and blue in luma (Rec. 709).
const LUMA_WEIGHTS: [f32; 3] = [0.2126, 0.7152, 0.0722];

impl Planes {
    /// Chroma at every pixel (4:4:4).
    pub fn full(picture: &Picture) -> Self {
        let pixels = picture.rgb.as_chunks::<3>().0;
        let (width, height) = (picture.width as usize, picture.height as usize);
        let chroma = pixels.iter().map(|pixel| chroma_codes(pixel.map(f32::from)));
        let (u, v) = chroma.map(|[u, v]| (u, v)).unzip();
        let y = pixels.iter().map(|pixel| luma_code(pixel.map(f32::from))).collect();
        Self { width, height, chroma: (width, height), y, u, v }
    }

    /// Chroma as the mean of 2x2 pixels (4:2:0). At odd edges, the last row or column is repeated.
    pub fn halved(picture: &Picture) -> Self {
        let pixels = picture.rgb.as_chunks::<3>().0;
        let (width, height) = (picture.width as usize, picture.height as usize);
        let chroma = (width.div_ceil(2), height.div_ceil(2));
        let (mut u, mut v) =
            (Vec::with_capacity(chroma.0 * chroma.1), Vec::with_capacity(chroma.0 * chroma.1));
        for cy in 0..chroma.1 {
            let rows = [2 * cy, (2 * cy + 1).min(height - 1)];
            for cx in 0..chroma.0 {
                let columns = [2 * cx, (2 * cx + 1).min(width - 1)];
                let mut sum = [0.0; 3];
                for pixel in rows.iter().flat_map(|y| columns.iter().map(move |x| y * width + x)) {
                    sum = std::array::from_fn(|i| sum[i] + f32::from(pixels[pixel][i]));
                }
                let [blue, red] = chroma_codes(sum.map(|part| part / 4.0));
                u.push(blue);
                v.push(red);
            }
        }
        let y = pixels.iter().map(|pixel| luma_code(pixel.map(f32::from))).collect();
        Self { width, height, chroma, y, u, v }
    }

    /// The planes in the order Y, Cb, Cr.
    pub fn all(&self) -> [&[u8]; 3] {
        [&self.y, &self.u, &self.v]
    }
}

/// The luma of codes in 0..=255.
fn luma([r, g, b]: [f32; 3]) -> f32 {
    LUMA_WEIGHTS[0] * r + LUMA_WEIGHTS[1] * g + LUMA_WEIGHTS[2] * b
}

fn luma_code(rgb: [f32; 3]) -> u8 {
    (16.5 + 219.0 / 255.0 * luma(rgb)) as u8
}

/// The chroma codes: the differences of blue and red from luma, scaled to 16..=240 around 128.
fn chroma_codes(rgb: [f32; 3]) -> [u8; 2] {
    let luma = luma(rgb);
    let scaled = |difference: f32, weight: f32| (128.5 + 112.0 / 255.0 * difference / (1.0 - weight)) as u8;
    [scaled(rgb[2] - luma, LUMA_WEIGHTS[2]), scaled(rgb[0] - luma, LUMA_WEIGHTS[0])]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_colours() {
        // Rec. 709: white, black, and the primaries of a test card.
        let codes = |r: u8, g: u8, b: u8| {
            let planes = Planes::full(&Picture::opaque(1, 1, vec![r, g, b]));
            [planes.y[0], planes.u[0], planes.v[0]]
        };
        assert_eq!(codes(255, 255, 255), [235, 128, 128]);
        assert_eq!(codes(0, 0, 0), [16, 128, 128]);
        assert_eq!(codes(255, 0, 0), [63, 102, 240]);
        assert_eq!(codes(0, 255, 0), [173, 42, 26]);
        assert_eq!(codes(0, 0, 255), [32, 240, 118]);
    }

    #[test]
    fn odd_edges_have_chroma() {
        let picture = Picture::opaque(3, 1, [[255, 0, 0], [255, 0, 0], [0, 0, 255]].concat());
        let planes = Planes::halved(&picture);
        assert_eq!((planes.chroma, &planes.u, &planes.v), ((2, 1), &vec![102, 240], &vec![240, 118]));
    }
}
