//! Decodes `background`: the environment that rays see if they hit nothing.

use super::colors::{color, color_or};
use super::fault::Fault;
use super::fields::Fields;
use super::image::{image, named_image};
use super::keys::keyed;
use super::node::Node;
use super::paint::encoding;
use super::transform::turn;
use super::values::{file_path, not_negative, switch, unit_vector};
use crate::appearance::environment::{CubeMap, EnvironmentTracks, FACES, FacesError, SkyTracks};
use crate::appearance::texture::{ColorEncoding, Image, SharedAsset};
use crate::base::color::Rgb;
use crate::base::math::DVec3;
use crate::geometry::transform::TransformTracks;

/// A colour, or a sky.
pub fn environment(node: Node<'_>) -> Option<EnvironmentTracks> {
    color_or(node, "background", &[("Gradient", gradient), ("CubeMap", cube_map), ("Equirect", equirect)])
}

fn gradient(node: Node<'_>) -> Option<EnvironmentTracks> {
    let mut fields = Fields::of(node, "`Gradient`")?;
    let bottom = fields.or("bottom", keyed(color), Rgb::ONE);
    let top = fields.or("top", keyed(color), Rgb::new(0.5, 0.7, 1.0));
    let up = fields.or("up", |node| unit_vector(node).map(|up| node.file.up.get().to_y_up(up)), DVec3::Y);
    let sky = bottom.zip(top).zip(up);
    finished(fields, sky.map(|((bottom, top), up)| SkyTracks::Gradient { bottom, top, up }))
}

fn equirect(node: Node<'_>) -> Option<EnvironmentTracks> {
    let mut fields = Fields::of_or_only(node, "`Equirect`", "file")?;
    let encoding = fields.or("encoding", encoding, ColorEncoding::Srgb);
    let file = fields.required("file", |node| {
        let image = image(encoding.unwrap_or_default())(node)?;
        let (width, height) = (image.width(), image.height());
        if width.abs_diff(2 * height) > 1 {
            let title = "the image of an `Equirect` must be twice as wide as high";
            node.fault(Fault::new(node.span(), title, format!("has {width} × {height} pixels")));
            return None;
        }
        Some(image)
    });
    finished(fields, encoding.and(file).map(SkyTracks::Equirect))
}

fn cube_map(node: Node<'_>) -> Option<EnvironmentTracks> {
    let mut fields = Fields::of_or_only(node, "`CubeMap`", "files")?;
    let mirrored = fields.or("mirrored", switch, false);
    let encoding = fields.or("encoding", encoding, ColorEncoding::Srgb);
    let faces = faces(&mut fields, encoding.unwrap_or_default());
    let sky = faces.and_then(|faces| joined(&fields, &faces));
    let sky = finished(fields, encoding.and(sky));
    Some(EnvironmentTracks { mirrored: mirrored?, ..sky? })
}

/// Completes a sky with the fields that all skies have.
fn finished(mut fields: Fields<'_>, sky: Option<SkyTracks>) -> Option<EnvironmentTracks> {
    let intensity = fields.or("intensity", keyed(not_negative), 1.0);
    let rotation = fields.or("rotation", turn(DVec3::Y), TransformTracks::default().rotation);
    fields.finish();
    Some(EnvironmentTracks { sky: sky?, intensity: intensity?, rotation: rotation?, mirrored: false })
}

/// Six files, or one name for all of them.
fn faces(fields: &mut Fields<'_>, encoding: ColorEncoding) -> Option<[SharedAsset<Image>; 6]> {
    if !fields.has("files") {
        let [px, nx, py, ny, pz, nz] = FACES.map(|face| fields.required(face, image(encoding)));
        return Some([px?, nx?, py?, ny?, pz?, nz?]);
    }
    let single = FACES.into_iter().find(|face| fields.has(face));
    let Some(face) = single else { return fields.required("files", |node| all_faces(node, encoding)) };
    let title = "a cube map has either `files` or the six faces one by one";
    let fault = Fault::new(fields.place(face), title, "one too many");
    fields.node().fault(fault.also(fields.place("files"), "the other one is here"));
    // These fields exist, so they must not be reported as unknown.
    for name in ["files"].into_iter().chain(FACES) {
        fields.optional(name, Some);
    }
    None
}

/// The images whose names have `px`, `nx` and so on in place of `*`.
fn all_faces(node: Node<'_>, encoding: ColorEncoding) -> Option<[SharedAsset<Image>; 6]> {
    let name = file_path(node)?;
    if name.matches('*').count() != 1 {
        node.expected("a name with one `*`, which stands for px, nx, py, ny, pz and nz");
        return None;
    }
    let [px, nx, py, ny, pz, nz] = FACES.map(|face| named_image(node, &name.replace('*', face), encoding));
    Some([px?, nx?, py?, ny?, pz?, nz?])
}

fn joined(fields: &Fields<'_>, faces: &[SharedAsset<Image>; 6]) -> Option<SkyTracks> {
    let size = |face: usize| {
        format!("`{}` has {} × {} pixels", FACES[face], faces[face].width(), faces[face].height())
    };
    let (face, label) = match CubeMap::new(faces.each_ref().map(|face| &**face)) {
        Ok(map) => return Some(SkyTracks::CubeMap(SharedAsset::new(map))),
        Err(FacesError::NotSquare(face)) => (face, size(face)),
        Err(FacesError::Differs(face)) => (face, format!("{}, {}", size(face), size(0))),
    };
    let title = "the faces of a cube map must be squares of one size";
    fields.node().fault(Fault::new(fields.place(FACES[face]), title, label));
    None
}
