//! Textures at one moment, and their evaluation at points of surfaces.

use super::texel::Lerp;
use super::{
    AxisWrap, DataTexture, Footprint, Image, Pattern, SharedAsset, SurfaceWrap, Texel, TextureFilter,
    TextureMapping, TextureSpace, Wrap,
};
use crate::base::color::Rgb;
use crate::base::digest::Content;
use crate::base::lanes::{Color, Mask, Real, Row, Select, Single, Vec3, lanes, out_of_line};
use crate::base::math::DVec3;
use crate::geometry::mesh::ArrayKey;
use crate::geometry::shape::Shape;
use crate::geometry::table_rows::TableRow;
use std::ops::BitOr;

/// Points of surfaces in lanes, with all that textures read there. Parts that no texture of the surface reads may be 0.
#[derive(Clone, Copy)]
pub struct TextureEvalContext<'a, F: Real = f64> {
    /// The u and v of the surface.
    pub uv: [F; 2],
    /// Whether the surface ends at 0 and 1 of u, and of v.
    pub ends: [F::Mask; 2],
    /// The point in the object's space, before the object is moved.
    pub point: Vec3<F>,
    /// Error bound of each coordinate of `point`; patterns read it together with the footprint.
    pub error: Vec3<F>,
    /// The interpolated vertex colour; white if the vertices have none.
    pub color: Color<F::F32>,
    /// The footprint of the pixel, in the object's space, and in u and v for uv-mapped patterns.
    pub footprint: Footprint<F>,
    pub footprint_uv: Footprint<F>,
    /// The part of the shape that was hit.
    pub part: F::U32,
    /// The object of each lane.
    pub objects: [TexturedObject<'a>; 8],
}

/// What of an object textures read.
#[derive(Clone, Copy, Debug, Default)]
pub struct TexturedObject<'a> {
    pub shape: Option<&'a Shape>,
    /// The numbers of a table that the object has besides those of its shape.
    pub row: Option<&'a TableRow>,
}

/// The parts of a [`TextureEvalContext`] that textures read. Every texture may read the point itself.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TextureInputs {
    /// `uv` and `ends`.
    pub uv: bool,
    pub color: bool,
    /// `footprint` and `error`.
    pub footprint: bool,
    /// `footprint_uv`; `footprint` and `error`, too.
    pub footprint_uv: bool,
}

impl BitOr for TextureInputs {
    type Output = Self;

    fn bitor(self, other: Self) -> Self {
        Self {
            uv: self.uv | other.uv,
            color: self.color | other.color,
            footprint: self.footprint | other.footprint,
            footprint_uv: self.footprint_uv | other.footprint_uv,
        }
    }
}

impl<F: Real> TextureEvalContext<'_, F> {
    /// Points at the origins of no objects.
    #[inline(always)]
    pub fn nowhere() -> Self {
        Self {
            uv: [F::splat(0.0); 2],
            ends: [F::Mask::splat(false); 2],
            point: Vec3::zero(),
            error: Vec3::zero(),
            color: Color::splat(Rgb::ONE),
            footprint: Footprint::zero(),
            footprint_uv: Footprint::zero(),
            part: F::U32::splat(0),
            objects: [TexturedObject::default(); 8],
        }
    }
}

impl TexturedObject<'_> {
    /// A number of the data of a mesh, of particles or of an instance at a point of a part.
    pub fn array(&self, key: &ArrayKey, point: DVec3, part: u32) -> Option<f64> {
        let of_shape = self.shape.and_then(|shape| shape.number(key, point, part));
        of_shape.or_else(|| self.row?.number(key))
    }
}

/// The relative error bound of u and v. A few operations compute them from a point whose error is far smaller, and an
/// error of 1e-12 of a surface is invisible.
const UV_ERROR: f64 = 1e-12;

/// A texture at one moment.
#[derive(Clone, Debug, PartialEq, Content)]
pub enum Texture {
    Color(Rgb),
    VertexColor,
    Data(Box<DataTexture>),
    Image(ImageTexture),
    Pattern(Box<PatternTexture>),
    Product(Box<ProductTexture>),
    Cutout(Box<CutoutTexture>),
}

/// The product of two textures, of their colours and of their alpha.
#[derive(Clone, Debug, PartialEq, Content)]
pub struct ProductTexture {
    pub first: Texture,
    pub second: Texture,
}

/// A texture without soft edges: it is opaque where its alpha is at least `cutoff`, and clear elsewhere.
#[derive(Clone, Debug, PartialEq, Content)]
pub struct CutoutTexture {
    pub texture: Texture,
    pub cutoff: f32,
}

/// An image on a surface.
#[derive(Clone, Debug, PartialEq, Content)]
pub struct ImageTexture {
    pub image: SharedAsset<Image>,
    /// Extends the image beyond its edges. `None` repeats it up to the ends of the surface.
    pub wrap: Option<Wrap>,
    pub filter: TextureFilter,
    /// One channel, used as grey.
    pub channel: Option<ColorChannel>,
    /// Factor of the colours.
    pub tint: Rgb,
    /// Whether the image's alpha is used.
    pub alpha: bool,
    /// Maps u and v to the image.
    pub mapping: TextureMapping,
    /// How the image repeats along its x and y under this mapping.
    pub surface_wrap: [SurfaceWrap; 2],
}

/// Two textures in a pattern. They may be patterns themselves.
#[derive(Clone, Debug, PartialEq, Content)]
pub struct PatternTexture {
    pub pattern: Pattern,
    pub space: TextureSpace,
    pub mapping: TextureMapping,
    pub first: Texture,
    pub second: Texture,
}

/// One of the three channels of a colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Content)]
pub enum ColorChannel {
    R,
    G,
    B,
}

impl From<Rgb> for Texture {
    fn from(color: Rgb) -> Self {
        Self::Color(color)
    }
}

impl Texture {
    /// Evaluates the texture at points in the lanes `wanted`: linear colours without negative channels, and alpha. The
    /// other lanes are arbitrary.
    #[inline(always)]
    pub fn at<F: Real>(&self, context: &TextureEvalContext<'_, F>, wanted: F::Mask) -> Texel<F::F32> {
        texel_at(self, context, wanted)
    }

    /// Whether any part may have alpha below 1.
    pub fn has_alpha(&self) -> bool {
        match self {
            Self::Color(_) | Self::VertexColor | Self::Data(_) => false,
            Self::Image(texture) => texture.alpha && texture.image.has_alpha(),
            Self::Pattern(texture) => texture.first.has_alpha() || texture.second.has_alpha(),
            Self::Product(texture) => texture.first.has_alpha() || texture.second.has_alpha(),
            // No alpha reaches a cutoff above 1.
            Self::Cutout(texture) => texture.cutoff > 1.0 || texture.texture.has_alpha(),
        }
    }

    /// The same texture without alpha.
    pub fn opaque(self) -> Self {
        match self {
            Self::Color(_) | Self::VertexColor | Self::Data(_) => self,
            Self::Image(texture) => Self::Image(ImageTexture { alpha: false, ..texture }),
            Self::Pattern(texture) => {
                let PatternTexture { first, second, .. } = *texture;
                let (first, second) = (first.opaque(), second.opaque());
                Self::Pattern(Box::new(PatternTexture { first, second, ..*texture }))
            }
            Self::Product(texture) => {
                let ProductTexture { first, second } = *texture;
                Self::Product(Box::new(ProductTexture { first: first.opaque(), second: second.opaque() }))
            }
            Self::Cutout(texture) => texture.texture.opaque(),
        }
    }

    /// What the texture reads at a point.
    pub fn inputs(&self) -> TextureInputs {
        let none = TextureInputs::default();
        match self {
            Self::Color(_) | Self::Data(_) => none,
            Self::VertexColor => TextureInputs { color: true, ..none },
            Self::Image(_) => TextureInputs { uv: true, ..none },
            Self::Pattern(texture) => {
                let own = match texture.space {
                    TextureSpace::Object => TextureInputs { footprint: true, ..none },
                    TextureSpace::Uv => TextureInputs { uv: true, footprint_uv: true, ..none },
                };
                own | texture.first.inputs() | texture.second.inputs()
            }
            Self::Product(texture) => texture.first.inputs() | texture.second.inputs(),
            Self::Cutout(texture) => texture.texture.inputs(),
        }
    }

    /// Whether any part is a pattern.
    pub fn has_pattern(&self) -> bool {
        match self {
            Self::Color(_) | Self::VertexColor | Self::Data(_) | Self::Image(_) => false,
            Self::Pattern(_) => true,
            Self::Product(texture) => texture.first.has_pattern() || texture.second.has_pattern(),
            Self::Cutout(texture) => texture.texture.has_pattern(),
        }
    }

    /// Calls `visit` with every part that shows data.
    pub fn each_data<'t>(&'t self, visit: &mut impl FnMut(&'t DataTexture)) {
        match self {
            Self::Color(_) | Self::VertexColor | Self::Image(_) => {}
            Self::Data(texture) => visit(texture),
            Self::Pattern(texture) => {
                texture.first.each_data(visit);
                texture.second.each_data(visit);
            }
            Self::Product(texture) => {
                texture.first.each_data(visit);
                texture.second.each_data(visit);
            }
            Self::Cutout(texture) => texture.texture.each_data(visit),
        }
    }

    /// The colour of a texture that is the same at every point.
    pub fn constant(&self) -> Option<Rgb> {
        if let Self::Color(color) = self { Some(*color) } else { None }
    }
}

out_of_line! {
    fn texel_at<'k, F>(
        texture: &'k Texture,
        context: &'k TextureEvalContext<'k, F>,
        wanted: F::Mask,
    ) -> Texel<F::F32> {
        match texture {
            Texture::Color(color) => Texel::opaque(Color::splat(*color)),
            Texture::VertexColor => Texel::opaque(context.color),
            Texture::Data(texture) => Texel::opaque(texture.at(context, wanted)),
            Texture::Image(texture) => texture.at(context, wanted),
            Texture::Pattern(texture) => texture.at(context, wanted),
            Texture::Product(texture) => {
                let (first, second) = (texture.first.at(context, wanted), texture.second.at(context, wanted));
                Texel { color: first.color * second.color, alpha: first.alpha * second.alpha }
            }
            Texture::Cutout(texture) => {
                let Texel { color, alpha } = texture.texture.at(context, wanted);
                let [zero, one] = [0.0, 1.0].map(F::F32::splat);
                Texel { color, alpha: F::F32::select(F::F32::splat(texture.cutoff).le(alpha), one, zero) }
            }
        }
    }
}

impl ImageTexture {
    #[inline(always)]
    fn at<F: Real>(&self, context: &TextureEvalContext<'_, F>, wanted: F::Mask) -> Texel<F::F32> {
        let (zero, [u, v]) = (F::splat(0.0), context.uv);
        let (at, _) = self.mapping.local(Vec3::new(u, v, zero), Vec3::zero());
        let axes = match self.wrap {
            Some(wrap) => [AxisWrap::from(wrap).splat(); 2],
            None => {
                let [across, up] = &self.surface_wrap;
                [across.resolve(context.ends), up.resolve(context.ends)]
            }
        };
        let Texel { color, alpha } = match self.alpha {
            true => self.image.texel_at([at.x, at.y], axes, self.filter, wanted),
            false => Texel::opaque(self.image.color_at([at.x, at.y], axes, self.filter, wanted)),
        };
        Texel { color: self.tinted(color), alpha }
    }

    #[inline(always)]
    fn tinted<S: Single>(&self, color: Color<S>) -> Color<S> {
        let color = match self.channel {
            Some(ColorChannel::R) => Color::grey(color.r),
            Some(ColorChannel::G) => Color::grey(color.g),
            Some(ColorChannel::B) => Color::grey(color.b),
            None => color,
        };
        color * Color::splat(self.tint)
    }

    /// The colour of an opaque image that is the same everywhere.
    pub fn constant(&self) -> Option<Rgb> {
        let there = !self.alpha || !self.image.has_alpha();
        let black = (there && self.tint == Rgb::ZERO).then_some(Rgb::ZERO);
        self.image.constant().map(|color| self.tinted::<f32>(color.into()).into()).or(black)
    }
}

impl PatternTexture {
    #[inline(always)]
    fn at<F: Real>(&self, context: &TextureEvalContext<'_, F>, wanted: F::Mask) -> Texel<F::F32> {
        let (zero, one, [u, v]) = (F::splat(0.0), F::splat(1.0), context.uv);
        let (point, error, seen) = match self.space {
            TextureSpace::Object => (context.point, context.error, &context.footprint),
            TextureSpace::Uv => {
                let [of_u, of_v] =
                    [(u.abs() + one) * F::splat(UV_ERROR), (v.abs() + one) * F::splat(UV_ERROR)];
                (Vec3::new(u, v, zero), Vec3::new(of_u, of_v, zero), &context.footprint_uv)
            }
        };
        let (point, error) = self.mapping.local(point, error);
        let seen = self.mapping.footprint(seen).extent();
        let (points, errors, seen) = (point.store(), error.store(), seen.store());
        let mut shares = F::F32::splat(0.0).to_array();
        for lane in lanes(wanted.bits()) {
            shares[lane] = self.pattern.share(points[lane], errors[lane], seen[lane]) as f32;
        }
        let share = F::F32::from_array(shares);
        let (zero, one) = (F::F32::splat(0.0), F::F32::splat(1.0));
        // Shares are in 0..=1. What has none is not evaluated.
        let (some_first, some_second) = (wanted & !one.le(share), wanted & !share.le(zero));
        if !some_second.any() {
            return self.first.at(context, wanted);
        }
        if !some_first.any() {
            return self.second.at(context, wanted);
        }
        let (first, second) = (self.first.at(context, some_first), self.second.at(context, some_second));
        let both = Texel::select(one.le(share), second, first.lerp(second, share));
        Texel::select(share.le(zero), first, both)
    }
}
