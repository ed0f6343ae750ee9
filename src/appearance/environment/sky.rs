//! Skies in their own coordinates: one colour, a gradient, or images.

use super::CubeMap;
use super::equirect;
use crate::appearance::texture::{AxisWrap, Image, SharedAsset, TextureFilter, Wrap};
use crate::base::color::Rgb;
use crate::base::digest::Content;
use crate::base::lanes::{Color, Mask, Real, Vec3, out_of_line};
use crate::base::math::{DVec2, DVec3};

/// Radiance from every direction.
#[derive(Clone, Debug, PartialEq, Content)]
pub enum Sky {
    Constant(Rgb),
    /// Linear in the height along the unit vector `up`, from `bottom` straight down to `top` straight up.
    Gradient {
        bottom: Rgb,
        top: Rgb,
        up: DVec3,
    },
    CubeMap(SharedAsset<CubeMap>),
    /// An equirectangular image: longitude to the right, latitude upwards, -z in the middle.
    Equirect(SharedAsset<Image>),
}

impl Sky {
    /// Radiance from directions, which are unit vectors.
    #[inline(always)]
    pub fn radiance<F: Real>(&self, direction: Vec3<F>) -> Color<F::F32> {
        let (zero, one) = (F::splat(0.0), F::splat(1.0));
        match self {
            Self::Constant(radiance) => Color::splat(*radiance),
            Self::Gradient { bottom, top, up } => {
                let height = F::splat(0.5) * (direction.dot(Vec3::splat(*up)) + one);
                let share = height.max(zero).min(one).to_f32();
                Color::splat(*bottom).lerp(Color::splat(*top), share)
            }
            Self::CubeMap(map) => map_radiance(map, direction),
            Self::Equirect(image) => image_radiance(image, direction),
        }
    }

    /// Radiance from one direction.
    pub fn radiance_from(&self, direction: DVec3) -> Rgb {
        self.radiance::<f64>(direction.into()).into()
    }

    /// Radiance from [`equirect::direction`] of `uv`.
    pub(super) fn radiance_at(&self, uv: DVec2) -> Rgb {
        match self {
            Self::Equirect(image) => image.sample(uv, axes(), TextureFilter::Bilinear),
            _ => self.radiance_from(equirect::direction(uv)),
        }
    }
}

out_of_line! {
    fn map_radiance<'k, F>(map: &'k CubeMap, direction: Vec3<F>) -> Color<F::F32> {
        map.radiance(direction)
    }
}

out_of_line! {
    fn image_radiance<'k, F>(image: &'k Image, direction: Vec3<F>) -> Color<F::F32> {
        let [across, up] = axes();
        let axes = [across.splat(), up.splat()];
        image.color_at(equirect::uv(direction), axes, TextureFilter::Bilinear, F::Mask::splat(true))
    }
}

/// The axes of an image of all directions. Columns repeat, so the first one follows the last one. Rows end at the
/// poles.
fn axes() -> [AxisWrap; 2] {
    [Wrap::Repeat.into(), Wrap::Clamp.into()]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::lanes::tests::on_all_levels;
    use crate::base::lanes::{Level, Row, SimdKernel, dispatch};
    use crate::testing::Random;

    #[test]
    fn gradients_go_evenly_with_height() {
        let (bottom, top) = (Rgb::ONE, Rgb::new(0.5, 0.7, 1.0));
        let sky = Sky::Gradient { bottom, top, up: DVec3::Y };
        assert_eq!(sky.radiance_from(DVec3::NEG_Y), bottom);
        assert_eq!(sky.radiance_from(DVec3::Y), top);
        let middle = sky.radiance_from(DVec3::X);
        assert!((middle - Rgb::new(0.75, 0.85, 1.0)).abs().max_element() < 1e-6);
        let tilted = Sky::Gradient { bottom, top, up: DVec3::Z };
        assert_eq!(tilted.radiance_from(DVec3::Z), top);
    }

    /// An image of 8 × 4 texels. Red is the column, green is the row from the top.
    fn numbered() -> Sky {
        let texels = (0..4u8).flat_map(|y| (0..8u8).map(move |x| Rgb::new(x.into(), y.into(), 0.0)));
        Sky::Equirect(SharedAsset::new(Image::new(8, 4, texels.collect()).expect("an image")))
    }

    #[test]
    fn equirect_images_have_minus_z_in_the_middle_and_x_to_the_right() {
        let sky = numbered();
        let radiance = |x: f64, y: f64, z: f64| sky.radiance_from(DVec3::new(x, y, z).normalize());
        assert_eq!(radiance(0.0, 0.0, -1.0), Rgb::new(3.5, 1.5, 0.0));
        assert_eq!(radiance(1.0, 0.0, 0.0), Rgb::new(5.5, 1.5, 0.0));
        assert_eq!(radiance(-1.0, 0.0, 0.0), Rgb::new(1.5, 1.5, 0.0));
        assert_eq!(radiance(0.0, 0.0, 1.0).x, 3.5, "the seam mixes the columns 0 and 7");
        assert_eq!((radiance(0.0, 1.0, 0.0).y, radiance(0.0, -1.0, 0.0).y), (0.0, 3.0));
    }

    struct Eight<'a>(&'a Sky, [DVec3; 8]);

    impl SimdKernel for Eight<'_> {
        type Output = [Rgb; 8];

        #[inline(always)]
        fn run<L: Level>(self) -> [Rgb; 8] {
            let [x, y, z] = [0, 1, 2].map(|axis| L::F64::from_array(self.1.map(|direction| direction[axis])));
            let light = self.0.radiance(Vec3::new(x, y, z));
            let (r, g, b) = (light.r.to_array(), light.g.to_array(), light.b.to_array());
            std::array::from_fn(|lane| Rgb::new(r[lane], g[lane], b[lane]))
        }
    }

    /// On all levels, eight directions have the radiance that each has alone, some of them zero or not finite.
    #[test]
    fn eight_directions_agree_with_single_ones() {
        let mut random = Random(14);
        let face = |face: u8| {
            let texels = (0..16u8).map(|i| Rgb::new(i.into(), face.into(), 1.0));
            Image::new(4, 4, texels.collect()).expect("a face")
        };
        let map = CubeMap::new([0, 1, 2, 3, 4, 5].map(face).each_ref()).expect("a cube map");
        let odd = [DVec3::ZERO, DVec3::NAN, DVec3::INFINITY, DVec3::new(1.0, f64::NAN, 0.0), DVec3::ONE];
        for sky in [numbered(), Sky::CubeMap(SharedAsset::new(map))] {
            for _ in 0..1000 {
                let mut directions: [DVec3; 8] = std::array::from_fn(|_| random.direction());
                let place = (random.unit() * 8.0) as usize;
                directions[place] = odd[(random.unit() * 5.0) as usize];
                let alone = directions.map(|direction| sky.radiance_from(direction));
                for (level, all) in on_all_levels(|| dispatch(Eight(&sky, directions))) {
                    assert_eq!(all, alone, "{level:?} {directions:?}");
                }
            }
        }
    }

    #[test]
    fn equirect_images_have_no_seam_and_firm_poles() {
        let sky = numbered();
        let mut random = Random(2);
        for _ in 0..1000 {
            let y = 2.0 * random.unit() - 1.0;
            let sides = [1e-9, -1e-9].map(|x| sky.radiance_from(DVec3::new(x, y, 1.0).normalize()));
            assert!((sides[0] - sides[1]).abs().max_element() < 1e-5);
            let tiny = random.point(1e-300) + DVec3::Y;
            assert_eq!(sky.radiance_from(tiny).y, 0.0, "the top row alone");
            assert!(sky.radiance_from(random.direction()).is_finite());
        }
    }
}
