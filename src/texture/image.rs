//! Images: texels in linear light, and what lies between them.

use crate::color::Rgb;
use crate::digest::content;
use crate::math::DVec2;

/// A picture in linear light; at least one texel wide and high.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    width: u32,
    height: u32,
    /// Row by row from the top left, as files have them.
    texels: Vec<Rgb>,
}

content!(struct Image { width, height, texels });

/// What is seen beyond the edges of an image.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Wrap {
    /// The image again.
    #[default]
    Repeat,
    /// The image and its mirror image in turn.
    Mirror,
    /// The texels at the edge.
    Clamp,
}

content!(
    enum Wrap {
        Repeat,
        Mirror,
        Clamp,
    }
);

/// What is seen between the centres of texels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Filter {
    /// A mixture of the four texels around.
    #[default]
    Bilinear,
    /// The nearest texel.
    Nearest,
}

content!(
    enum Filter {
        Bilinear,
        Nearest,
    }
);

impl Image {
    /// An image of `width` × `height` texels, row by row from the top left; none if there are more or fewer of
    /// them, or none at all.
    pub fn new(width: u32, height: u32, texels: Vec<Rgb>) -> Option<Self> {
        let right = !texels.is_empty() && u64::from(width) * u64::from(height) == texels.len() as u64;
        right.then_some(Self { width, height, texels })
    }

    pub fn width(&self) -> u32 {
        self.width
    }

    pub fn height(&self) -> u32 {
        self.height
    }

    /// The texel in column `x` from the left and row `y` from the top; both inside the image.
    pub fn texel(&self, x: u32, y: u32) -> Rgb {
        self.texels[y as usize * self.width as usize + x as usize]
    }

    /// The colour at `uv`: u runs to the right and v upwards, both from 0 to 1 over the whole image, so the
    /// centre of the texel in column i is at u = (i + 0.5) / width. Black where `uv` is not finite.
    pub fn sample(&self, uv: DVec2, wrap: Wrap, filter: Filter) -> Rgb {
        self.sample_wrapped(uv, [wrap; 2], filter)
    }

    /// [`Image::sample`] with a wrap for u and one for v.
    pub fn sample_wrapped(&self, uv: DVec2, [across, up]: [Wrap; 2], filter: Filter) -> Rgb {
        if !uv.is_finite() {
            return Rgb::ZERO;
        }
        let texel = |x: u32, from_bottom: u32| self.texel(x, self.height - 1 - from_bottom);
        match filter {
            Filter::Nearest => texel(across.nearest(uv.x, self.width), up.nearest(uv.y, self.height)),
            Filter::Bilinear => {
                let (x, y) = (across.between(uv.x, self.width), up.between(uv.y, self.height));
                let low = texel(x.low, y.low).lerp(texel(x.high, y.low), x.share);
                let high = texel(x.low, y.high).lerp(texel(x.high, y.high), x.share);
                low.lerp(high, y.share)
            }
        }
    }
}

/// Two neighbours, and how far from the lower to the higher one.
struct Between {
    low: u32,
    high: u32,
    share: f32,
}

impl Wrap {
    /// A finite coordinate brought into 0..=1. The end is reached by rounding alone, or by clamping.
    fn reduced(self, coordinate: f64) -> f64 {
        match self {
            Self::Repeat => coordinate - coordinate.floor(),
            Self::Mirror => 1.0 - (1.0 - (coordinate - 2.0 * (coordinate * 0.5).floor())).abs(),
            Self::Clamp => coordinate.clamp(0.0, 1.0),
        }
    }

    fn nearest(self, coordinate: f64, size: u32) -> u32 {
        ((self.reduced(coordinate) * f64::from(size)) as u32).min(size - 1)
    }

    fn between(self, coordinate: f64, size: u32) -> Between {
        let at = self.reduced(coordinate) * f64::from(size) - 0.5;
        let low = at.floor();
        let index = |i: i64| self.index(i, i64::from(size)) as u32;
        Between { low: index(low as i64), high: index(low as i64 + 1), share: (at - low) as f32 }
    }

    /// Which texel stands at index -1..=size of a row. A mirrored image repeats the texels at its edge.
    fn index(self, i: i64, size: i64) -> i64 {
        match self {
            Self::Repeat => i.rem_euclid(size),
            Self::Mirror | Self::Clamp => i.clamp(0, size - 1),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Random;

    const WRAPS: [Wrap; 3] = [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp];

    /// Grey texels, row by row from the top.
    fn grey(width: u32, texels: &[f32]) -> Image {
        let texels: Vec<_> = texels.iter().map(|&value| Rgb::splat(value)).collect();
        Image::new(width, texels.len() as u32 / width, texels).expect("an image")
    }

    fn at(image: &Image, u: f64, v: f64, wrap: Wrap) -> f32 {
        image.sample(DVec2::new(u, v), wrap, Filter::Bilinear).x
    }

    #[test]
    fn texels_are_met_at_their_centres() {
        let image = grey(4, &[0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);
        for wrap in WRAPS {
            for filter in [Filter::Bilinear, Filter::Nearest] {
                for (x, y) in (0..4).flat_map(|x| [(x, 0), (x, 1)]) {
                    let uv = DVec2::new((f64::from(x) + 0.5) / 4.0, 1.0 - (f64::from(y) + 0.5) / 2.0);
                    assert_eq!(image.sample(uv, wrap, filter), image.texel(x, y));
                }
            }
        }
        assert_eq!(at(&image, 0.125, 0.25, Wrap::Clamp), 4.0, "v runs upwards");
    }

    #[test]
    fn bilinear_is_exact_for_planes() {
        let (width, height) = (7, 5);
        let plane = |u: f64, v: f64| 0.25 + 0.5 * u - 0.125 * v;
        let texels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| {
            let (u, v) = ((f64::from(x) + 0.5) / 7.0, 1.0 - (f64::from(y) + 0.5) / 5.0);
            plane(u, v) as f32
        });
        let image = grey(width, &texels.collect::<Vec<_>>());
        let mut random = Random(1);
        for _ in 0..1000 {
            let (u, v) = (0.1 + 0.8 * random.unit(), 0.1 + 0.8 * random.unit());
            assert!((f64::from(at(&image, u, v, Wrap::Clamp)) - plane(u, v)).abs() < 1e-6);
        }
    }

    #[test]
    fn wraps_continue_beyond_the_edges() {
        let image = grey(2, &[0.0, 1.0]);
        for (wrap, expected) in [
            (Wrap::Repeat, [0.5, 0.0, 1.0, 0.5, 0.0, 1.0]),
            (Wrap::Mirror, [0.0, 0.0, 1.0, 1.0, 1.0, 0.0]),
            (Wrap::Clamp, [0.0, 0.0, 1.0, 1.0, 1.0, 1.0]),
        ] {
            let got = [0.0, 0.25, 0.75, 1.0, 1.25, 1.75].map(|u| at(&image, u, 0.5, wrap));
            assert_eq!(got, expected, "{wrap:?}");
        }
        assert_eq!(at(&image, -0.25, 0.5, Wrap::Repeat), 1.0);
        assert_eq!(at(&image, -0.25, 0.5, Wrap::Mirror), 0.0);
    }

    #[test]
    fn sh_13_the_seam_of_a_repeated_image_does_not_show() {
        let image = grey(5, &[0.9, 0.2, 0.4, 0.1, 0.3]);
        for whole in [-3.0, 0.0, 1.0, 100.0] {
            let jump =
                at(&image, whole - 1e-9, 0.5, Wrap::Repeat) - at(&image, whole + 1e-9, 0.5, Wrap::Repeat);
            assert!(jump.abs() < 1e-6);
        }
    }

    #[test]
    fn sh_13_no_coordinate_leaves_the_image() {
        let ends = [
            0.0,
            -0.0,
            1.0,
            1.0 - f64::from(f32::EPSILON) / 2.0,
            1.0f64.next_down(),
            -1e-300,
            5e-324,
            1e18,
            -1e300,
        ];
        let beyond = [f64::MAX, f64::INFINITY, f64::NEG_INFINITY, f64::NAN, -1.0, 2.0f64.next_down()];
        let image = grey(3, &[0.1, 0.5, 0.9, 0.4, 0.3, 0.2]);
        let coordinates: Vec<_> = ends.into_iter().chain(beyond).collect();
        for (&u, &v) in coordinates.iter().flat_map(|u| coordinates.iter().map(move |v| (u, v))) {
            for (wrap, filter) in
                WRAPS.into_iter().flat_map(|w| [(w, Filter::Bilinear), (w, Filter::Nearest)])
            {
                let color = image.sample(DVec2::new(u, v), wrap, filter);
                let finite = u.is_finite() && v.is_finite();
                assert!(if finite { color.x >= 0.1 - 1e-6 && color.x <= 0.9 } else { color == Rgb::ZERO });
            }
        }
    }

    #[test]
    fn sizes_must_fit() {
        assert_eq!(Image::new(2, 1, vec![Rgb::ONE]), None);
        assert_eq!(Image::new(0, 0, vec![]), None);
    }
}
