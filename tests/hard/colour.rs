//! Colour. CO-01 and CO-02 stand in `src/encode/develop/tests.rs` and `src/base/color.rs`.

use crate::support::shoot_all;
use kinora::encode::{ToneTable, Tonemap};

/// Filters work in linear light: half of white is code 188. Of encoded values it would be 128.
#[test]
fn co_03_edges_and_textures_are_filtered_in_linear_light() {
    let folder = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).expect("the folder is writable");
    let path = folder.path().join("four.png");
    let texels =
        image::GrayImage::from_fn(2, 2, |x, y| image::Luma([if (x + y) % 2 == 0 { 255 } else { 0 }]));
    texels.save(&path).expect("a disk");
    let white = "ambient: 0, diffuse: 0, emission: 1";
    let edge = format!(
        "\"edge\": (shape: Triangle(a: (-9, -9, 0), b: (9, -9, 0), c: (9, 9, 0)), material: ({white}, color: 1))"
    );
    let image = format!(
        "\"four\": (shape: Rectangle(corner: (-1, -1, 0), u: (2, 0, 0), v: (0, 2, 0)),
        material: ({white}, color: Image(file: {path:?}, filter: Nearest)))"
    );
    for (objects, height) in [(&edge, 1.0), (&image, 2.0), (&image, 1e-3)] {
        for filter in ["Box", "Tent", "Gaussian"] {
            let wide = filter != "Box";
            // Wider filters see beyond the object's edges; the edge at 45 degrees goes on.
            if wide && objects == &image && height > 1.0 {
                continue;
            }
            let text = format!(
                "(output: (size: (1, 1)), quality: (integrator: Path, samples: 4096, bounces: 0, filter: {filter}),
                camera: (position: (0, 0, 5), projection: Orthographic(height: {height:?})), objects: {{ {objects} }})"
            );
            let (picture, _) = ToneTable::new(Tonemap::Srgb).develop(&shoot_all(&text)[0].film);
            let code = i32::from(picture.rgb[0]);
            assert!((code - 188).abs() <= 1, "{filter} of {height}: {code}");
        }
    }
}
