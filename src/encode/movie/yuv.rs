//! Pictures as video has them: brightness and two differences of colour, by the matrix of Rec. 709, in the limited
//! range (black is 16 and white 235).

use crate::encode::picture::Picture;

/// Three planes of codes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Planes {
    pub width: usize,
    pub height: usize,
    /// Size of the planes of colour.
    pub chroma: (usize, usize),
    pub y: Vec<u8>,
    pub u: Vec<u8>,
    pub v: Vec<u8>,
}

/// Shares of red, green and blue in brightness (Rec. 709).
const SHARES: [f32; 3] = [0.2126, 0.7152, 0.0722];

impl Planes {
    /// Colour at every pixel.
    pub fn full(picture: &Picture) -> Self {
        let pixels = picture.rgb.as_chunks::<3>().0;
        let (width, height) = (picture.width as usize, picture.height as usize);
        let differences = pixels.iter().map(|pixel| differences(pixel.map(f32::from)));
        let (u, v) = differences.map(|[u, v]| (u, v)).unzip();
        let y = pixels.iter().map(|pixel| brightness(pixel.map(f32::from))).collect();
        Self { width, height, chroma: (width, height), y, u, v }
    }

    /// Colour for squares of four pixels, as the mean of them; at odd edges of those that are there.
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
                let [blue, red] = differences(sum.map(|part| part / 4.0));
                u.push(blue);
                v.push(red);
            }
        }
        let y = pixels.iter().map(|pixel| brightness(pixel.map(f32::from))).collect();
        Self { width, height, chroma, y, u, v }
    }

    /// The planes in their order.
    pub fn all(&self) -> [&[u8]; 3] {
        [&self.y, &self.u, &self.v]
    }
}

/// Brightness of codes in 0..=255.
fn luma([r, g, b]: [f32; 3]) -> f32 {
    SHARES[0] * r + SHARES[1] * g + SHARES[2] * b
}

fn brightness(rgb: [f32; 3]) -> u8 {
    (16.5 + 219.0 / 255.0 * luma(rgb)) as u8
}

/// The differences of blue and red to the brightness, scaled to 16..=240 around 128.
fn differences(rgb: [f32; 3]) -> [u8; 2] {
    let luma = luma(rgb);
    let scaled = |difference: f32, share: f32| (128.5 + 112.0 / 255.0 * difference / (1.0 - share)) as u8;
    [scaled(rgb[2] - luma, SHARES[2]), scaled(rgb[0] - luma, SHARES[0])]
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
    fn odd_edges_have_colour_too() {
        let picture = Picture::opaque(3, 1, [[255, 0, 0], [255, 0, 0], [0, 0, 255]].concat());
        let planes = Planes::halved(&picture);
        assert_eq!((planes.chroma, &planes.u, &planes.v), ((2, 1), &vec![102, 240], &vec![240, 118]));
    }
}
