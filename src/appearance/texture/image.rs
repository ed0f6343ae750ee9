//! Images: texels in linear light, and filtering between them.

use super::texel::{Lerp, Texel};
use super::wrap::{AxisWrap, LaneWrap};
use crate::base::color::Rgb;
use crate::base::digest::Content;
use crate::base::lanes::{Color, Mask, Real, Row, Single, lanes};
use crate::base::math::DVec2;

/// An image in linear light, at least one texel wide and high.
#[derive(Clone, Debug, PartialEq, Content)]
pub struct Image {
    width: u32,
    height: u32,
    /// Row by row from the top left, as in files.
    texels: Vec<Rgb>,
    /// Alpha of each texel, in 0..=1. `None` if all texels are opaque.
    alpha: Option<Vec<f32>>,
    /// Whether all texels are equal.
    is_uniform: bool,
}

/// Reconstruction between the centres of texels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Content)]
pub enum TextureFilter {
    /// Bilinear interpolation of the four nearest texels.
    #[default]
    Bilinear,
    /// The nearest texel.
    Nearest,
}

impl Image {
    /// An image of `width` × `height` texels, row by row from the top left. `None` if the number of texels differs or
    /// is 0.
    pub fn new(width: u32, height: u32, texels: Vec<Rgb>) -> Option<Self> {
        let right = !texels.is_empty() && u64::from(width) * u64::from(height) == texels.len() as u64;
        let is_uniform = texels.iter().all(|texel| *texel == texels[0]);
        right.then_some(Self { width, height, texels, alpha: None, is_uniform })
    }

    /// Adds alpha in 0..=1 for each texel. `None` if the number of values differs from that of the texels.
    pub fn with_alpha(mut self, alpha: Vec<f32>) -> Option<Self> {
        if alpha.len() != self.texels.len() {
            return None;
        }
        let opaque = alpha.iter().all(|alpha| *alpha == 1.0);
        self.is_uniform &= alpha.iter().all(|other| *other == alpha[0]);
        self.alpha = (!opaque).then_some(alpha);
        Some(self)
    }

    pub fn width(&self) -> u32 {
        self.width
    }

    pub fn height(&self) -> u32 {
        self.height
    }

    /// Whether any texel has alpha below 1.
    pub fn has_alpha(&self) -> bool {
        self.alpha.is_some()
    }

    /// The colour of an opaque image that is the same everywhere.
    pub fn constant(&self) -> Option<Rgb> {
        (self.is_uniform && self.alpha.is_none()).then(|| self.texels[0])
    }

    /// The colour of the texel in column `x` from the left and row `y` from the top. Both must be inside the image.
    pub fn texel(&self, x: u32, y: u32) -> Rgb {
        self.texels[self.index(x, y)]
    }

    /// The alpha of the texel in column `x` from the left and row `y` from the top. Both must be inside the image.
    pub fn alpha(&self, x: u32, y: u32) -> f32 {
        self.alpha.as_ref().map_or(1.0, |alpha| alpha[self.index(x, y)])
    }

    #[inline(always)]
    fn index(&self, x: u32, y: u32) -> usize {
        y as usize * self.width as usize + x as usize
    }

    /// The colour at `uv`, ignoring alpha. u runs to the right and v upwards, both from 0 to 1 over the whole image. So
    /// the centre of the texel in column i is at u = (i + 0.5) / width. The colour is black if `uv` is not finite.
    pub fn sample(&self, uv: DVec2, axes: [AxisWrap; 2], filter: TextureFilter) -> Rgb {
        self.color_at::<f64>(uv.into(), axes.map(AxisWrap::splat), filter, true).into()
    }

    /// [`Image::sample`] with alpha.
    pub fn sample_alpha(&self, uv: DVec2, axes: [AxisWrap; 2], filter: TextureFilter) -> Texel {
        self.texel_at::<f64>(uv.into(), axes.map(AxisWrap::splat), filter, true)
    }

    /// [`Image::sample`] in the lanes `wanted`. The others are arbitrary.
    #[inline(always)]
    pub fn color_at<F: Real>(
        &self,
        uv: [F; 2],
        axes: [LaneWrap<F>; 2],
        filter: TextureFilter,
        wanted: F::Mask,
    ) -> Color<F::F32> {
        let (uv, wanted) = finite(uv, wanted);
        match filter {
            TextureFilter::Nearest => self.colors::<F>(self.nearest(uv, axes), wanted),
            TextureFilter::Bilinear => {
                let Corners { low, high, fractions } = self.corners(uv, axes);
                // All texels are read before any is used: those of large images are waited for together.
                let low = [self.colors::<F>(low[0], wanted), self.colors::<F>(low[1], wanted)];
                let high = [self.colors::<F>(high[0], wanted), self.colors::<F>(high[1], wanted)];
                interpolate(low, high, fractions)
            }
        }
    }

    /// [`Image::sample_alpha`] in the lanes `wanted`. The others are arbitrary.
    #[inline(always)]
    pub fn texel_at<F: Real>(
        &self,
        uv: [F; 2],
        axes: [LaneWrap<F>; 2],
        filter: TextureFilter,
        wanted: F::Mask,
    ) -> Texel<F::F32> {
        let Some(alpha) = &self.alpha else { return Texel::opaque(self.color_at(uv, axes, filter, wanted)) };
        let (uv, wanted) = finite(uv, wanted);
        match filter {
            TextureFilter::Nearest => self.texels::<F>(alpha, self.nearest(uv, axes), wanted),
            TextureFilter::Bilinear => {
                let Corners { low, high, fractions } = self.corners(uv, axes);
                let low = [self.texels::<F>(alpha, low[0], wanted), self.texels::<F>(alpha, low[1], wanted)];
                let high =
                    [self.texels::<F>(alpha, high[0], wanted), self.texels::<F>(alpha, high[1], wanted)];
                interpolate(low, high, fractions)
            }
        }
    }

    /// The indices of the texels nearest to finite points.
    #[inline(always)]
    fn nearest<F: Real>(&self, [u, v]: [F; 2], [across, up]: [LaneWrap<F>; 2]) -> Indices<F> {
        self.indices(across.nearest(u, self.width), up.nearest(v, self.height))
    }

    /// The texels around finite points.
    #[inline(always)]
    fn corners<F: Real>(&self, [u, v]: [F; 2], [across, up]: [LaneWrap<F>; 2]) -> Corners<F> {
        let (x, y) = (across.texels_around(u, self.width), up.texels_around(v, self.height));
        Corners {
            low: [self.indices(x.low, y.low), self.indices(x.high, y.low)],
            high: [self.indices(x.low, y.high), self.indices(x.high, y.high)],
            fractions: [x.fraction, y.fraction],
        }
    }

    /// The indices of texels in columns and rows, the latter from the bottom.
    #[inline(always)]
    fn indices<F: Real>(&self, column: F, row: F) -> Indices<F> {
        // Rows are counted from the top in memory.
        let row = F::splat(f64::from(self.height) - 1.0) - row;
        [column.to_u32().to_array(), row.to_u32().to_array()]
    }

    /// The colours of texels in the lanes `wanted`; black in the others.
    #[inline(always)]
    fn colors<F: Real>(&self, [columns, rows]: Indices<F>, wanted: u32) -> Color<F::F32> {
        let black = F::F32::splat(0.0).to_array();
        let (mut r, mut g, mut b) = (black, black, black);
        for lane in lanes(wanted) {
            (r[lane], g[lane], b[lane]) = self.texels[self.index(columns[lane], rows[lane])].into();
        }
        Color { r: F::F32::from_array(r), g: F::F32::from_array(g), b: F::F32::from_array(b) }
    }

    /// Texels in the lanes `wanted`; opaque black in the others.
    #[inline(always)]
    fn texels<F: Real>(&self, alpha: &[f32], at: Indices<F>, wanted: u32) -> Texel<F::F32> {
        let ([columns, rows], mut alphas) = (at, F::F32::splat(1.0).to_array());
        for lane in lanes(wanted) {
            alphas[lane] = alpha[self.index(columns[lane], rows[lane])];
        }
        Texel { color: self.colors::<F>(at, wanted), alpha: F::F32::from_array(alphas) }
    }
}

/// The columns of texels in all lanes, and their rows from the top.
type Indices<F> = [<<F as Real>::U32 as Row>::Array; 2];

/// The texels around points, from the left: of the lower row, and of the higher one.
struct Corners<F: Real> {
    low: [Indices<F>; 2],
    high: [Indices<F>; 2],
    /// Of the way from the left to the right, and from the lower row to the higher one.
    fractions: [F::F32; 2],
}

/// The values between four corners.
#[inline(always)]
fn interpolate<S: Single, T: Lerp<S>>(low: [T; 2], high: [T; 2], [across, up]: [S; 2]) -> T {
    let [low, high] = [low[0].lerp(low[1], across), high[0].lerp(high[1], across)];
    low.lerp(high, up)
}

/// The coordinates, or 0 in lanes in which one is not finite, and the bits of the other lanes of a mask.
#[inline(always)]
fn finite<F: Real>([u, v]: [F; 2], wanted: F::Mask) -> ([F; 2], u32) {
    let (zero, infinity) = (F::splat(0.0), F::splat(f64::INFINITY));
    let is_finite = u.abs().lt(infinity) & v.abs().lt(infinity);
    ([F::select(is_finite, u, zero), F::select(is_finite, v, zero)], (is_finite & wanted).bits())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::appearance::texture::Wrap;
    use crate::testing::Random;

    const WRAPS: [Wrap; 3] = [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp];

    /// Grey texels, row by row from the top.
    fn grey(width: u32, texels: &[f32]) -> Image {
        let texels: Vec<_> = texels.iter().map(|&value| Rgb::splat(value)).collect();
        Image::new(width, texels.len() as u32 / width, texels).expect("an image")
    }

    fn at(image: &Image, u: f64, v: f64, wrap: Wrap) -> f32 {
        image.sample(DVec2::new(u, v), [wrap.into(); 2], TextureFilter::Bilinear).x
    }

    #[test]
    fn texels_are_met_at_their_centres() {
        let image = grey(4, &[0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);
        for wrap in WRAPS {
            for filter in [TextureFilter::Bilinear, TextureFilter::Nearest] {
                for (x, y) in (0..4).flat_map(|x| [(x, 0), (x, 1)]) {
                    let uv = DVec2::new((f64::from(x) + 0.5) / 4.0, 1.0 - (f64::from(y) + 0.5) / 2.0);
                    assert_eq!(image.sample(uv, [wrap.into(); 2], filter), image.texel(x, y));
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
                WRAPS.into_iter().flat_map(|w| [(w, TextureFilter::Bilinear), (w, TextureFilter::Nearest)])
            {
                let color = image.sample(DVec2::new(u, v), [wrap.into(); 2], filter);
                let finite = u.is_finite() && v.is_finite();
                assert!(if finite { color.x >= 0.1 - 1e-6 && color.x <= 0.9 } else { color == Rgb::ZERO });
            }
        }
    }

    /// A row that repeats three times and ends there.
    #[test]
    fn repeated_images_end_at_whole_numbers() {
        let image = grey(2, &[0.25, 0.75]);
        let ends = [AxisWrap::repeating(-1.0, 2.0), Wrap::Clamp.into()];
        let at = |u: f64, filter| image.sample(DVec2::new(u, 0.5), ends, filter).x;
        let smooth =
            [-1.5, -1.0, -0.9, 0.0, 1.0, 1.75, 1.9, 2.0, 2.5].map(|u| at(u, TextureFilter::Bilinear));
        assert_eq!(smooth, [0.25, 0.25, 0.25, 0.5, 0.5, 0.75, 0.75, 0.75, 0.75]);
        let firm = [-1.0, -1e-9, 0.0, 1.0, 2.0].map(|u| at(u, TextureFilter::Nearest));
        assert_eq!(firm, [0.25, 0.75, 0.25, 0.25, 0.75]);
        let wrapped = image.sample(DVec2::new(2.0, 0.5), [Wrap::Repeat.into(); 2], TextureFilter::Nearest).x;
        assert_eq!(wrapped, 0.25, "without an end the next one begins");
    }

    #[test]
    fn transparent_texels_do_not_bleed() {
        let texels = vec![Rgb::X, Rgb::Y, Rgb::Z, Rgb::ONE];
        let image = Image::new(4, 1, texels).and_then(|image| image.with_alpha(vec![1.0, 0.0, 0.5, 1.0]));
        let image = image.expect("an image");
        assert!(image.has_alpha() && image.constant().is_none());
        let at =
            |u: f64| image.sample_alpha(DVec2::new(u, 0.5), [Wrap::Clamp.into(); 2], TextureFilter::Bilinear);
        assert_eq!(at(0.25), Texel { color: Rgb::X.into(), alpha: 0.5 });
        assert_eq!(at(0.375), Texel { color: Rgb::Y.into(), alpha: 0.0 });
        assert_eq!(at(0.5), Texel { color: Rgb::Z.into(), alpha: 0.25 });
        let Texel { color, alpha } = at(0.75);
        assert_eq!(alpha, 0.75);
        let color = Rgb::from(color);
        assert!((color - Rgb::new(2.0, 2.0, 3.0) / 3.0).abs().max_element() < 1e-6, "{color}");
        assert_eq!(
            image.sample(DVec2::new(0.375, 0.5), [Wrap::Clamp.into(); 2], TextureFilter::Nearest),
            Rgb::Y
        );
    }

    #[test]
    fn images_of_one_colour_are_constant() {
        let even = grey(3, &[0.5; 6]);
        assert_eq!(even.constant(), Some(Rgb::splat(0.5)));
        assert_eq!(grey(3, &[0.5, 0.5, 0.5, 0.5, 0.5, 0.6]).constant(), None);
        let opaque = even.clone().with_alpha(vec![1.0; 6]).expect("an image");
        assert!(opaque == even && !opaque.has_alpha());
        assert_eq!(even.clone().with_alpha(vec![0.5; 6]).expect("an image").constant(), None);
        assert_eq!(even.with_alpha(vec![0.5; 5]), None);
    }

    #[test]
    fn sizes_must_fit() {
        assert_eq!(Image::new(2, 1, vec![Rgb::ONE]), None);
        assert_eq!(Image::new(0, 0, vec![]), None);
    }
}
