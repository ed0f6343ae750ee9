//! The files that a sequence is read from: what has no end does not stop the reader, and one file is read once.

use crate::support::folder;
use assert_cmd::Command;
use kinora::appearance::material::MaterialTracks;
use kinora::appearance::texture::TextureTracks;
use kinora::sequence::{Sequence, load};
use std::fs;
use std::path::Path;

fn sequence_in(folder: &Path, text: &str) -> Result<Sequence, String> {
    let path = folder.join("scene.ron");
    fs::write(&path, text).expect("a disk");
    load(&path).map_err(|error| error.to_string())
}

#[cfg(unix)]
#[test]
fn pipes_and_devices_are_refused_and_not_waited_for() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    for name in ["pipe.png", "pipe.ply", "pipe.mtl"] {
        let made = std::process::Command::new("mkfifo").arg(at(name)).status().expect("a command");
        assert!(made.success());
    }
    std::os::unix::fs::symlink("/dev/zero", at("zero.mtl")).expect("a disk");
    fs::write(at("a.obj"), "mtllib pipe.mtl\nv 0 0 0\n").expect("a disk");
    fs::write(at("b.obj"), "mtllib zero.mtl\nv 0 0 0\n").expect("a disk");
    fs::write(at("c.obj"), "mtllib .\nv 0 0 0\n").expect("a disk");
    let why = "it is a device or a pipe, not a regular file";
    for (file, expected) in [
        ("a.obj", format!("line 1: `pipe.mtl` cannot be read: {why}")),
        ("b.obj", "line 1: `zero.mtl` cannot be read: it is outside of ".to_owned()),
        ("c.obj", "line 1: `.` cannot be read: it is a folder".to_owned()),
        ("pipe.ply", why.to_owned()),
    ] {
        let text = format!("(objects: {{ \"a\": (shape: Mesh({file:?})) }})");
        let printed = sequence_in(folder.path(), &text).expect_err(file);
        assert!(printed.contains(&expected), "{printed}");
    }
    let text = "(background: Equirect(\"pipe.png\"))";
    let printed = sequence_in(folder.path(), text).expect_err("a pipe");
    assert!(printed.contains("cannot read the image \"pipe.png\"") && printed.contains(why), "{printed}");
}

/// A pipe as the sequence itself is no mistake: whoever names it writes to it.
#[cfg(unix)]
#[test]
fn a_sequence_may_come_through_a_pipe() {
    let mut command = Command::cargo_bin("kinora").expect("the binary is built with its tests");
    command.args(["check", "/dev/stdin"]).write_stdin("(objects: { \"a\": (shape: Sphere()) })");
    let output = command.output().expect("the binary runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn libraries_may_be_named_many_times() {
    let folder = folder();
    let names = "a.mtl ./a.mtl ".repeat(100);
    fs::write(folder.path().join("a.mtl"), "newmtl a\nKd 1 0 0\n").expect("a disk");
    let text = format!("mtllib {names}\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n");
    fs::write(folder.path().join("a.obj"), text).expect("a disk");
    let sequence = sequence_in(folder.path(), "(objects: { \"a\": (shape: Mesh(\"a.obj\")) })");
    assert_eq!(sequence.unwrap_or_else(|error| panic!("{error}")).materials.len(), 2);
}

#[test]
fn an_image_of_many_names_is_read_once() {
    let folder = folder();
    image::RgbImage::new(1, 1).save(folder.path().join("a.png")).expect("a disk");
    let sequence = sequence_in(
        folder.path(),
        "(materials: { \"a\": (color: Image(\"a.png\")), \"b\": (color: Image(\"./a.png\")),
                       \"c\": (color: Image(file: \"a.png\", encoding: Linear)) })",
    );
    let sequence = sequence.unwrap_or_else(|error| panic!("{error}"));
    let image = |material: &MaterialTracks| match &material.base {
        TextureTracks::Image(tracks) => tracks.image.clone(),
        other => panic!("{other:?}"),
    };
    let [a, b, c] = [0, 1, 2].map(|index| image(&sequence.materials[index].value));
    assert!(a == b, "one image under two names");
    assert!(a != c, "another encoding gives other texels");
}

/// The nearest folder with `assets` in it bounds what a sequence may name, wherever links lead.
#[cfg(unix)]
#[test]
fn files_outside_the_root_are_not_read() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    fs::create_dir_all(at("project/assets")).expect("a disk");
    fs::create_dir_all(at("project/scenes")).expect("a disk");
    image::RgbImage::new(1, 1).save(at("secret.png")).expect("a disk");
    image::RgbImage::new(1, 1).save(at("project/assets/open.png")).expect("a disk");
    fs::write(at("secret.mtl"), "newmtl a\n").expect("a disk");
    let triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    fs::write(at("secret.obj"), format!("{triangle}f 1 2 3\n")).expect("a disk");
    let with = |head: &str| format!("{head}\n{triangle}usemtl a\nf 1 2 3\n");
    fs::write(at("project/scenes/library.obj"), with("mtllib ../../secret.mtl")).expect("a disk");
    fs::write(at("project/scenes/map.obj"), with("mtllib map.mtl")).expect("a disk");
    fs::write(at("project/scenes/map.mtl"), "newmtl a\nmap_Kd ../../secret.png\n").expect("a disk");
    std::os::unix::fs::symlink(at("secret.png"), at("project/scenes/link.png")).expect("a disk");
    let absolute = at("secret.png").to_string_lossy().into_owned();
    let image = |name: &str| format!("(background: Equirect({name:?}))");
    let mesh = |name: &str| format!("(objects: {{ \"a\": (shape: Mesh({name:?})) }})");
    let scene = at("project/scenes/scene.ron");
    for (text, good) in [
        (image("../assets/open.png"), true),
        (image("../../secret.png"), false),
        (image(&absolute), false),
        (image("link.png"), false),
        (mesh("../../secret.obj"), false),
        (mesh("library.obj"), false),
        (mesh("map.obj"), false),
    ] {
        fs::write(&scene, &text).expect("a disk");
        let printed = load(&scene).map_err(|error| error.to_string()).err();
        assert_eq!(printed.is_none(), good, "{text}: {printed:?}");
        assert!(printed.is_none_or(|printed| printed.contains("--allow-outside")), "{text}");
        let check = |options: &[&str]| {
            let mut command = Command::cargo_bin("kinora").expect("the binary is built with its tests");
            command.arg("check").args(options).arg(&scene).output().expect("the binary runs").status.code()
        };
        assert_eq!((check(&[]) == Some(0), check(&["--allow-outside"])), (good, Some(0)), "{text}");
    }
}

/// What a file says of its own size is not believed.
#[test]
fn oversized_headers_are_refused_at_once() {
    let folder = folder();
    let mut png = Vec::new();
    let mut encoder = png::Encoder::new(&mut png, 16_000, 8_000);
    encoder.set_color(png::ColorType::Rgb);
    let mut writer = encoder.write_header().expect("memory");
    writer.write_chunk(png::chunk::IDAT, &[0x78, 0x9c, 3, 0, 0, 0, 0, 1]).expect("memory");
    drop(writer);
    fs::write(folder.path().join("a.png"), png).expect("a disk");
    let header = "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty float x\n\
                  property float y\nproperty float z\nelement face 1\n\
                  property list uchar int vertex_indices\nend_header\n";
    fs::write(folder.path().join("a.ply"), header).expect("a disk");
    fs::write(folder.path().join("a.hdr"), "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 60000 +X 60000\n")
        .expect("a disk");
    for (text, name) in [
        ("(background: Equirect(\"a.png\"))", "a.png"),
        ("(background: Equirect(\"a.hdr\"))", "a.hdr"),
        ("(objects: { \"a\": (shape: Mesh(\"a.ply\")) })", "a.ply"),
    ] {
        let printed = sequence_in(folder.path(), text).expect_err(name);
        assert!(printed.contains(name), "{printed}");
    }
}
