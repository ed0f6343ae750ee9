//! Image files → linear texels.

use super::{Image, ImageError};
use crate::base::color::{Rgb, srgb_to_linear};
use crate::base::{files, machine};
use image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader, Limits, Rgba};
use std::borrow::Cow;
use std::io::Cursor;
use std::path::Path;

/// The meaning of integers in an image file. Files of floating-point numbers are always linear.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum ColorEncoding {
    /// Colours in sRGB encoding.
    #[default]
    Srgb,
    /// Linear values, such as light, roughness or masks.
    Linear,
}

/// The largest file in bytes.
const MAX_FILE_BYTES: u64 = 1 << 30;

/// Maximum texels along a side.
const MAX_SIDE: u32 = 16_384;

/// Maximum texels: 1.5 GiB.
const MAX_TEXELS: u64 = 1 << 27;

impl Image {
    /// Reads a PNG, JPEG, BMP, Radiance HDR or OpenEXR file. The first bytes decide the format. A photograph is turned
    /// upright by its EXIF orientation.
    pub fn load(path: &Path, encoding: ColorEncoding) -> Result<Self, ImageError> {
        Self::decode(&files::read(path, MAX_FILE_BYTES)?, encoding)
    }

    /// [`Image::load`] from the bytes of a file.
    pub fn decode(bytes: &[u8], encoding: ColorEncoding) -> Result<Self, ImageError> {
        if files::is_truncated(bytes) {
            return Err(ImageError::Truncated);
        }
        let bytes = &with_common_signature(bytes);
        let mut limits = Limits::default();
        limits.max_alloc = Some(MAX_TEXELS * size_of::<[f32; 4]>() as u64);
        let mut reader = ImageReader::new(Cursor::new(bytes)).with_guessed_format()?;
        let is_exr = reader.format() == Some(ImageFormat::OpenExr);
        reader.limits(limits);
        let mut decoder = reader.into_decoder()?;
        let (width, height) = decoder.dimensions();
        let too_large = |limit: String| Err(ImageError::TooLarge { size: (width, height), limit });
        if width.max(height) > MAX_SIDE {
            return too_large(format!("the limit is {MAX_SIDE} along a side"));
        }
        if u64::from(width) * u64::from(height) > MAX_TEXELS {
            return too_large(format!("the limit is {MAX_TEXELS} in total"));
        }
        // The decoded data, a copy with its channels, and the texels.
        let pixels = u64::from(width) * u64::from(height);
        let texel = size_of::<Rgb>() + if decoder.color_type().has_alpha() { size_of::<f32>() } else { 0 };
        machine::check_memory(2 * decoder.total_bytes() + pixels * texel as u64)?;
        let orientation = decoder.orientation()?;
        let mut picture = DynamicImage::from_decoder(decoder)?;
        picture.apply_orientation(orientation);
        if is_exr {
            picture = straight(picture);
        }
        let (width, height) = (picture.width(), picture.height());
        let alpha = picture.color().has_alpha().then(|| alpha(&picture));
        let image = Self::new(width, height, texels(picture, encoding));
        let image = match alpha {
            Some(alpha) => image.and_then(|image| image.with_alpha(alpha)),
            None => image,
        };
        image.ok_or(ImageError::Empty)
    }
}

/// The signature of most HDR files.
const RADIANCE: &[u8] = b"#?RADIANCE";

/// Gives HDR files with the signature of other programs the common one. The data after it is the same.
fn with_common_signature(bytes: &[u8]) -> Cow<'_, [u8]> {
    match bytes.strip_prefix(b"#?RGBE") {
        Some(rest) => [RADIANCE, rest].concat().into(),
        None => bytes.into(),
    }
}

/// Divides colours by their alpha. EXR files hold products of both, other files colours alone.
fn straight(picture: DynamicImage) -> DynamicImage {
    let DynamicImage::ImageRgba32F(mut pixels) = picture else { return picture };
    for Rgba([r, g, b, alpha]) in pixels.pixels_mut() {
        if *alpha > 0.0 && *alpha < 1.0 {
            [r, g, b].into_iter().for_each(|channel| *channel /= *alpha);
        }
    }
    pixels.into()
}

/// Texels row by row in linear light, from grey or colours of 8 bits, 16 bits or f32.
fn texels(picture: DynamicImage, encoding: ColorEncoding) -> Vec<Rgb> {
    let color = picture.color();
    match color.bytes_per_pixel() / color.channel_count() {
        1 => {
            let table = table(u8::MAX.into(), encoding);
            picture.into_rgb8().pixels().map(|p| p.0.map(|code| table[usize::from(code)]).into()).collect()
        }
        2 => {
            let table = table(u16::MAX.into(), encoding);
            picture.into_rgb16().pixels().map(|p| p.0.map(|code| table[usize::from(code)]).into()).collect()
        }
        _ => picture.into_rgb32f().pixels().map(|p| p.0.map(radiance).into()).collect(),
    }
}

/// The alpha of each pixel, row by row. Alpha is linear whatever the encoding of colours.
fn alpha(picture: &DynamicImage) -> Vec<f32> {
    let share = |code: u32, last: u32| (f64::from(code) / f64::from(last)) as f32;
    match picture {
        DynamicImage::ImageLumaA8(picture) => {
            picture.pixels().map(|p| share(p.0[1].into(), u8::MAX.into())).collect()
        }
        DynamicImage::ImageRgba8(picture) => {
            picture.pixels().map(|p| share(p.0[3].into(), u8::MAX.into())).collect()
        }
        DynamicImage::ImageLumaA16(picture) => {
            picture.pixels().map(|p| share(p.0[1].into(), u16::MAX.into())).collect()
        }
        DynamicImage::ImageRgba16(picture) => {
            picture.pixels().map(|p| share(p.0[3].into(), u16::MAX.into())).collect()
        }
        _ => {
            let share = |alpha: f32| if alpha.is_nan() { 0.0 } else { alpha.clamp(0.0, 1.0) };
            picture.to_rgba32f().pixels().map(|p| share(p.0[3])).collect()
        }
    }
}

/// The linear value of every code up to `last`.
fn table(last: u32, encoding: ColorEncoding) -> Vec<f32> {
    let linear = |code: u32| match (f64::from(code) / f64::from(last), encoding) {
        (shown, ColorEncoding::Srgb) => srgb_to_linear(shown) as f32,
        (amount, ColorEncoding::Linear) => amount as f32,
    };
    (0..=last).map(linear).collect()
}

/// The largest number of 16 bits: what a sun is at least whose light did not fit into its file.
const BRIGHTEST_HALF: f32 = 65504.0;

/// Replaces invalid light: negative numbers and those that are none become 0, infinite ones the largest of 16 bits.
fn radiance(value: f32) -> f32 {
    match value.is_finite() {
        true => value.max(0.0),
        false if value > 0.0 => BRIGHTEST_HALF,
        false => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::appearance::texture::{TextureFilter, Wrap};
    use crate::base::math::DVec2;
    use image::{ImageBuffer, Luma, LumaA, Rgb as Pixel};

    fn encoded(picture: impl Into<DynamicImage>, format: ImageFormat) -> Vec<u8> {
        let mut bytes = Cursor::new(Vec::new());
        picture.into().write_to(&mut bytes, format).expect("an encoder");
        bytes.into_inner()
    }

    fn decoded(bytes: &[u8], encoding: ColorEncoding) -> Image {
        Image::decode(bytes, encoding).unwrap_or_else(|error| panic!("{error}"))
    }

    #[test]
    fn codes_are_decoded_unless_they_are_linear() {
        let picture = ImageBuffer::from_fn(2, 2, |x, y| Pixel([(128 * x) as u8, (255 * y) as u8, 188]));
        for format in [ImageFormat::Png, ImageFormat::Bmp] {
            let bytes = encoded(picture.clone(), format);
            let shown = decoded(&bytes, ColorEncoding::Srgb);
            let expected = [128.0, 255.0, 188.0].map(|code| srgb_to_linear(code / 255.0) as f32);
            assert_eq!(shown.texel(1, 1), Rgb::from(expected));
            assert_eq!(shown.texel(1, 0).y, 0.0, "the first row is the top one");
            let linear = decoded(&bytes, ColorEncoding::Linear);
            assert_eq!(linear.texel(0, 1), Rgb::new(0.0, 1.0, 188.0 / 255.0));
        }
    }

    #[test]
    fn grey_deep_and_transparent_files_are_read() {
        let grey = ImageBuffer::from_pixel(1, 1, Luma([51u8]));
        assert_eq!(
            decoded(&encoded(grey, ImageFormat::Png), ColorEncoding::Linear).texel(0, 0),
            Rgb::splat(0.2)
        );
        let deep = ImageBuffer::from_pixel(1, 1, Pixel([0u16, 65535, 13107]));
        let deep = encoded(deep, ImageFormat::Png);
        assert_eq!(decoded(&deep, ColorEncoding::Linear).texel(0, 0), Rgb::new(0.0, 1.0, 0.2));
    }

    #[test]
    fn alpha_is_linear_whatever_the_encoding() {
        let nearest = |image: &Image| {
            image.sample_alpha(DVec2::splat(0.5), [Wrap::Clamp.into(); 2], TextureFilter::Nearest).alpha
        };
        let red = |alpha| ImageBuffer::from_pixel(2, 1, Rgba([255u8, 0, 0, alpha]));
        let pictures: [DynamicImage; 3] = [
            red(51).into(),
            ImageBuffer::from_pixel(2, 1, LumaA([255u8, 51])).into(),
            ImageBuffer::from_pixel(2, 1, Rgba([0u16, 65535, 0, 13107])).into(),
        ];
        for picture in pictures {
            for encoding in [ColorEncoding::Srgb, ColorEncoding::Linear] {
                let image = decoded(&encoded(picture.clone(), ImageFormat::Png), encoding);
                assert!(image.has_alpha() && nearest(&image) == 0.2, "{image:?}");
            }
        }
        assert_eq!(decoded(&encoded(red(0), ImageFormat::Png), ColorEncoding::Srgb).texel(0, 0), Rgb::X);
        assert!(!decoded(&encoded(red(255), ImageFormat::Png), ColorEncoding::Srgb).has_alpha());
    }

    #[test]
    fn floating_point_files_are_linear() {
        let picture = ImageBuffer::from_pixel(3, 2, Pixel([8.0f32, 0.5, 0.25]));
        let hdr = encoded(picture.clone(), ImageFormat::Hdr);
        let other = [b"#?RGBE", &hdr[RADIANCE.len()..]].concat();
        for bytes in [hdr, other, encoded(picture, ImageFormat::OpenExr)] {
            for encoding in [ColorEncoding::Srgb, ColorEncoding::Linear] {
                assert_eq!(decoded(&bytes, encoding).texel(2, 1), Rgb::new(8.0, 0.5, 0.25));
            }
        }
    }

    #[test]
    fn exr_files_hold_products_of_colour_and_alpha() {
        let pixels = [
            Rgba([0.5f32, 0.25, 0.0, 0.5]),
            Rgba([f32::INFINITY, f32::NAN, -1.0, 1.0]),
            Rgba([2.0, 0.0, 0.0, f32::NAN]),
        ];
        let picture = ImageBuffer::from_fn(3, 1, |x, _| pixels[x as usize]);
        let image = decoded(&encoded(picture, ImageFormat::OpenExr), ColorEncoding::Srgb);
        assert_eq!((image.texel(0, 0), image.alpha(0, 0)), (Rgb::new(1.0, 0.5, 0.0), 0.5));
        assert_eq!((image.texel(1, 0), image.alpha(1, 0)), (Rgb::new(BRIGHTEST_HALF, 0.0, 0.0), 1.0));
        assert_eq!(image.alpha(2, 0), 0.0);
    }

    #[test]
    fn photographs_are_read() {
        let grey = ImageBuffer::from_pixel(16, 16, Pixel([128u8; 3]));
        let texel = decoded(&encoded(grey, ImageFormat::Jpeg), ColorEncoding::Linear).texel(8, 8);
        assert!((texel - Rgb::splat(128.0 / 255.0)).abs().max_element() < 0.01);
    }

    #[test]
    fn files_that_are_not_images_are_refused() {
        let refused =
            |bytes: &[u8]| Image::decode(bytes, ColorEncoding::Srgb).expect_err("no image").to_string();
        for bytes in [&b""[..], b"some text", b"GIF89a and so on", b"\x00\x01\x02"] {
            assert_eq!(refused(bytes), "it is not a PNG, JPEG, BMP, HDR or EXR image");
        }
        let picture = ImageBuffer::from_fn(64, 64, |x, y| Pixel([(x * y) as u8, x as u8, y as u8]));
        for format in [ImageFormat::Png, ImageFormat::Bmp, ImageFormat::Jpeg] {
            let bytes = encoded(picture.clone(), format);
            // A PNG that lacks only its end marker still has its whole picture.
            let end = bytes.len() - if format == ImageFormat::Png { 20 } else { 1 };
            for cut in [end, bytes.len() / 2, 20] {
                let message = refused(&bytes[..cut]);
                assert_eq!(message, "it is damaged: the file is truncated", "{format:?} {cut}");
            }
        }
        // The frame header becomes a comment.
        let mut jpeg = encoded(picture, ImageFormat::Jpeg);
        let header = jpeg.windows(2).position(|marker| marker == [0xff, 0xc0]).expect("a frame header");
        jpeg[header + 1] = 0xfe;
        assert_eq!(refused(&jpeg), "it is damaged: its JPEG data cannot be decoded");
    }

    #[test]
    fn damaged_files_do_not_panic() {
        let picture = ImageBuffer::from_fn(24, 16, |x, y| Pixel([(x * 9) as u8, (x * y) as u8, y as u8]));
        let float = DynamicImage::from(picture.clone()).into_rgb32f();
        let mut random = crate::testing::Random(7);
        let files =
            [ImageFormat::Png, ImageFormat::Jpeg, ImageFormat::Bmp].map(|f| encoded(picture.clone(), f));
        let floats = [ImageFormat::Hdr, ImageFormat::OpenExr].map(|format| encoded(float.clone(), format));
        for file in files.into_iter().chain(floats) {
            for _ in 0..200 {
                let mut bytes = file.clone();
                for _ in 0..3 {
                    let at = (random.unit() * bytes.len() as f64) as usize;
                    bytes[at] = (random.unit() * 256.0) as u8;
                }
                bytes.truncate((random.unit() * 2.0 * bytes.len() as f64) as usize);
                let _ = Image::decode(&bytes, ColorEncoding::Srgb);
            }
        }
    }

    #[test]
    fn absurd_sizes_are_refused() {
        // Only the header of a BMP. Width and height are at offsets 18 and 22.
        let mut bytes = encoded(ImageBuffer::from_pixel(1, 1, Pixel([0u8; 3])), ImageFormat::Bmp);
        for (width, height, why) in [
            (60_000u32, 4u32, "it has 60000x4 pixels; the limit is 16384 along a side"),
            (4, 16_385, "it has 4x16385 pixels; the limit is 16384 along a side"),
            (16_384, 16_384, "it has 16384x16384 pixels; the limit is 134217728 in total"),
        ] {
            bytes[18..22].copy_from_slice(&width.to_le_bytes());
            bytes[22..26].copy_from_slice(&height.to_le_bytes());
            let error = Image::decode(&bytes, ColorEncoding::Srgb).expect_err("too large");
            assert_eq!(error.to_string(), why);
        }
    }

    #[test]
    fn missing_files_have_the_usual_message() {
        let error = Image::load(Path::new("no/such/file.png"), ColorEncoding::Srgb).expect_err("no file");
        assert_eq!(error.to_string(), "there is no such file");
    }
}
