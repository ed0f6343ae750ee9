//! Textures at one moment, and their evaluation at points of surfaces.

use super::{
    DataTexture, Footprint, Image, Pattern, SharedAsset, SurfaceWrap, Texel, TextureFilter, TextureMapping,
    TextureSpace, Wrap,
};
use crate::base::color::Rgb;
use crate::base::digest::Content;
use crate::base::math::{DVec2, DVec3};
use crate::geometry::mesh::ArrayKey;
use crate::geometry::shape::Shape;
use crate::geometry::table_rows::TableRow;
use std::ops::BitOr;

/// A point of a surface, with all that textures read there. Parts that no texture of the surface reads may be 0.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TextureEvalContext<'a> {
    /// The u and v of the surface.
    pub uv: DVec2,
    /// Whether the surface ends at 0 and 1 of u, and of v.
    pub ends: [bool; 2],
    /// The point in the object's space, before the object is moved.
    pub point: DVec3,
    /// Error bound of each coordinate of `point`.
    pub error: DVec3,
    /// The interpolated vertex colour; white if the vertices have none.
    pub color: Rgb,
    /// The footprint of the pixel, in the object's space, and in u and v for uv-mapped patterns.
    pub footprint: Footprint,
    pub footprint_uv: Footprint,
    /// The shape, and the part of it that was hit.
    pub shape: Option<&'a Shape>,
    pub part: u32,
    /// The numbers of a table that the object has besides those of its shape.
    pub row: Option<&'a TableRow>,
}

/// The parts of a [`TextureEvalContext`] that textures read. Every texture may read the point itself.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TextureInputs {
    /// `uv` and `ends`.
    pub uv: bool,
    pub color: bool,
    pub footprint: bool,
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

impl TextureEvalContext<'_> {
    /// A number of the data of a mesh, of particles or of an instance.
    pub fn array(&self, key: &ArrayKey) -> Option<f64> {
        let of_shape = self.shape.and_then(|shape| shape.number(key, self.point, self.part));
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
    /// Evaluates the texture at a point: a linear colour without negative channels, and alpha.
    pub fn at(&self, context: &TextureEvalContext<'_>) -> Texel {
        match self {
            Self::Color(color) => Texel::opaque(*color),
            Self::VertexColor => Texel::opaque(context.color),
            Self::Data(texture) => Texel::opaque(texture.at(context)),
            Self::Image(texture) => texture.at(context),
            Self::Pattern(texture) => texture.at(context),
            Self::Product(texture) => {
                let (first, second) = (texture.first.at(context), texture.second.at(context));
                Texel { color: first.color * second.color, alpha: first.alpha * second.alpha }
            }
            Self::Cutout(texture) => {
                let Texel { color, alpha } = texture.texture.at(context);
                Texel { color, alpha: if alpha >= texture.cutoff { 1.0 } else { 0.0 } }
            }
        }
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

impl ImageTexture {
    pub fn at(&self, context: &TextureEvalContext<'_>) -> Texel {
        let (at, _) = self.mapping.local(context.uv.extend(0.0), DVec3::ZERO);
        let axes = match self.wrap {
            Some(wrap) => [wrap.into(); 2],
            None => self.surface_wrap.map(|surface_wrap| surface_wrap.resolve(context.ends)),
        };
        let Texel { color, alpha } = match self.alpha {
            true => self.image.sample_alpha(at.truncate(), axes, self.filter),
            false => Texel::opaque(self.image.sample(at.truncate(), axes, self.filter)),
        };
        Texel { color: self.tinted(color), alpha }
    }

    fn tinted(&self, color: Rgb) -> Rgb {
        self.channel.map_or(color, |channel| Rgb::splat(color[channel as usize])) * self.tint
    }

    /// The colour of an opaque image that is the same everywhere.
    pub fn constant(&self) -> Option<Rgb> {
        let there = !self.alpha || !self.image.has_alpha();
        let black = (there && self.tint == Rgb::ZERO).then_some(Rgb::ZERO);
        self.image.constant().map(|color| self.tinted(color)).or(black)
    }
}

impl PatternTexture {
    pub fn at(&self, context: &TextureEvalContext<'_>) -> Texel {
        let (point, error, seen) = match self.space {
            TextureSpace::Object => (context.point, context.error, &context.footprint),
            TextureSpace::Uv => (
                context.uv.extend(0.0),
                ((context.uv.abs() + 1.0) * UV_ERROR).extend(0.0),
                &context.footprint_uv,
            ),
        };
        let (point, error) = self.mapping.local(point, error);
        let seen = self.mapping.footprint(seen).extent();
        match self.pattern.share(point, error, seen) as f32 {
            0.0 => self.first.at(context),
            1.0 => self.second.at(context),
            share => self.first.at(context).lerp(self.second.at(context), share),
        }
    }
}
