//! The vertices of recorded paths.

/// A vertex of a path. Indices are cheaper to collect than names.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum PathVertex {
    /// A material by its index, and how it scattered the path.
    Surface(u32, ScatterKind),
    /// A light by its index.
    Light(u32),
    Background,
    /// A material by its index that emits light.
    Emission(u32),
}

/// How a surface scattered a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ScatterKind {
    Scattered,
    Mirrored,
    Glossy,
    Refracted,
    Transmitted,
}

impl ScatterKind {
    pub fn name(self) -> &'static str {
        match self {
            Self::Scattered => "",
            Self::Mirrored => " (mirrored)",
            Self::Glossy => " (glossy)",
            Self::Refracted => " (refracted)",
            Self::Transmitted => " (transmitted)",
        }
    }
}
