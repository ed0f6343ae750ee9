//! What is too much is refused in words, before it takes time, memory or files.

use crate::command::{BALL, folder, kinora, refused, run, stderr};
use kinora::sequence::parse;
use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

/// Writes a sequence with these fields.
fn write(folder: &Path, name: &str, fields: &str) {
    fs::write(folder.join(name), format!("({fields})")).expect("the folder is writable");
}

/// Runs it with no more than so many kibibytes of addresses, and gives its message; it must be refused.
#[cfg(target_os = "linux")]
fn refused_within(kibibytes: u64, folder: &Path, arguments: &[&str]) -> String {
    let mut command = std::process::Command::new("sh");
    command.args(["-c", &format!("ulimit -v {kibibytes}; exec \"$@\""), "sh"]);
    let binary = assert_cmd::cargo::cargo_bin("kinora");
    let done = command.arg(binary).args(arguments).current_dir(folder).output().expect("a shell");
    let printed = stderr(&done);
    assert_eq!(done.status.code(), Some(2), "{arguments:?}: {printed}");
    printed
}

#[cfg(target_os = "linux")]
#[test]
fn films_beyond_memory_are_refused_in_advance() {
    const LITTLE: u64 = 2 << 20;
    let folder = folder();
    let (path, before) = (folder.path(), crate::command::contents(folder.path()));
    let long = BALL.replace("frames: 12", "frames: 400");
    fs::write(path.join("long.ron"), long).expect("the folder is writable");
    for (arguments, what, mend) in [
        (
            &["render", "ball.ron", "-s", "6000x6000", "-o", "a.png", "--frames", "0"][..],
            "the picture needs",
            "--size",
        ),
        (&["filmstrip", "long.ron", "-n", "400", "-s", "1000x1000"], "the filmstrip needs", "fewer frames"),
        (&["accuracy", "ball.ron", "--quick", "-s", "4000x4000"], "to compare pictures", "--size"),
    ] {
        let printed = refused_within(LITTLE, path, arguments);
        assert!(printed.contains(what) && printed.contains(" of memory and there are "), "{printed}");
        assert!(printed.contains(mend), "{printed}");
    }
    fs::remove_file(path.join("long.ron")).expect("a file");
    assert_eq!(crate::command::contents(path), before);
    assert!(!path.join("output/ball_accuracy").exists());
}

/// A file may hold far more numbers than bytes.
#[cfg(target_os = "linux")]
#[test]
fn small_files_of_many_numbers_are_refused_in_advance() {
    let folder = folder();
    let path = folder.path();
    let names: String = (0..996).map(|column| format!(",\"c{column}\":0")).collect();
    let rows = "{\"t\":0}\n".repeat(150_000);
    fs::write(path.join("sparse.jsonl"), format!("{{\"t\":0,\"x\":0,\"y\":0,\"z\":0{names}}}\n{rows}"))
        .expect("a disk");
    let zeros = vec![0; 50_000_000];
    let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::best());
    std::io::Write::write_all(&mut encoder, &zeros).expect("memory");
    let block = encoder.finish().expect("memory");
    let header = [1, zeros.len() as u32, 0, block.len() as u32].map(u32::to_le_bytes);
    let zeros = base64::Engine::encode(
        &base64::engine::general_purpose::STANDARD,
        [header.as_flattened(), &block].concat(),
    );
    let array = |name: &str| {
        format!("<DataArray type=\"UInt8\" Name=\"{name}\" format=\"binary\">{zeros}</DataArray>")
    };
    for (name, cells) in [("many.vtu", 50_000_000), ("one.vtu", 1)] {
        let text = format!(
            "<VTKFile type=\"UnstructuredGrid\" compressor=\"vtkZLibDataCompressor\"><UnstructuredGrid>\
             <Piece NumberOfPoints=\"1\" NumberOfCells=\"{cells}\"><Points><DataArray type=\"Int8\" NumberOfComponents=\"3\">\
             0 0 0</DataArray></Points><Cells><DataArray type=\"Int8\" Name=\"connectivity\"></DataArray>{}{}</Cells></Piece>\
             </UnstructuredGrid></VTKFile>",
            array("offsets"),
            array("types")
        );
        fs::write(path.join(name), text).expect("a disk");
    }
    for (file, why) in [
        ("poses: \"sparse.jsonl\", shape: Sphere()", "MB of memory, but only"),
        ("shape: Mesh(\"many.vtu\")", "MB of memory, but only"),
        ("shape: Mesh(\"one.vtu\")", "`NumberOfCells` is 1, but the array `offsets` has 50000000 numbers"),
    ] {
        write(path, "large.ron", &format!("objects: {{ \"o\": ({file}) }}"));
        let printed = refused_within(600_000, path, &["check", "large.ron"]);
        assert!(printed.contains(why), "{printed}");
    }
}

#[test]
fn check_and_render_refuse_the_same_sequences() {
    let folder = folder();
    let path = folder.path();
    for (output, message) in [
        ("size: (65536, 65536)", "the picture needs 412 GB"),
        ("size: (20000, 8), files: \"a.webp\"", "a WebP ends at 16384x16384"),
        ("size: (65536, 8), files: \"a.gif\"", "a GIF ends at 65535x65535"),
    ] {
        write(path, "large.ron", &format!("timeline: (frames: 2), output: ({output})"));
        for command in ["check", "render"] {
            let printed = refused(path, &[command, "large.ron"]);
            assert!(printed.contains(message), "{command}: {printed}");
        }
    }
    let printed = kinora(path, &["check", "ball.ron"]);
    assert!(printed.contains("12 frames"), "{printed}");
}

#[test]
fn endless_checks_are_refused() {
    let printed = |fields: &str| {
        parse("a.ron", &format!("({fields})")).map(|_| ()).map_err(|faults| faults.to_string())
    };
    let camera = "camera: (shutter: 1, path: Orbit())";
    let message = printed(&format!("timeline: (frames: 10000000), quality: (shutter_steps: 4096), {camera}"));
    let message = message.expect_err("40 thousand million moments");
    assert!(message.contains("10000000 frames with 4096 moments each"), "{message}");
    assert!(message.contains("fewer frames") && message.contains("timeline"), "{message}");
    let message = printed(&format!("timeline: (frames: 1000000), quality: (shutter_steps: 32), {camera}"));
    assert!(message.expect_err("32 million moments").contains("write `shutter_steps: 16` or less"));
    // What stands still, or has no shutter, has one moment a frame.
    let many = "timeline: (frames: 100000), quality: (shutter_steps: 4096)";
    assert_eq!(printed(&format!("{many}, camera: (shutter: 1)")), Ok(()));
    assert_eq!(printed(&format!("{many}, camera: (path: Orbit())")), Ok(()));

    let chain = (0..2000).map(|index| {
        let parent = if index == 0 { String::new() } else { format!(", parent: \"{}\"", index - 1) };
        format!("\"{index}\": (shape: Group, translation: [(0, (0, 0, 0)), (1, (1e30, 0, 0))]{parent}),")
    });
    let chain: String = chain.collect();
    let message = printed(&format!("timeline: (frames: 10000000), objects: {{ {chain} }}"));
    let message = message.expect_err("objects far away");
    assert!(message.contains("for 10000000 frames") && message.contains("translation"), "{message}");
}

/// So many entries, of groups without anything in them.
fn groups(count: usize) -> String {
    (0..count).fold(String::from("(objects: {"), |text, index| text + &format!("\"{index}\":(shape:Group),"))
        + "})"
}

#[test]
#[ignore = "takes ten seconds; cargo test --release --test integration a_million -- --ignored"]
fn lists_may_have_a_million_entries() {
    let sequence = parse("a.ron", &groups(1_000_000)).map_err(|faults| faults.to_string());
    assert_eq!(sequence.map(|sequence| sequence.objects.len()), Ok(1_000_000));
}

/// Before they are read, which would take a while where they stand in many brackets.
#[test]
fn lists_of_more_than_a_million_entries_are_refused_at_once() {
    let long = |entry: &str| entry.repeat(1_000_001);
    for text in [
        groups(1_000_001),
        format!("(lights: {{ \"a\": Point(intensity: [{}]) }})", long("(0, 1), ")),
        format!("(objects: {{ \"a\": (shape: Mesh(vertices: [{}])) }})", long("(0, 0, 1), ")),
        format!("(camera: (position: ({})))", long("1, ")),
        format!("({})", long("a: 1, ")),
    ] {
        let begun = Instant::now();
        let printed = parse("a.ron", &text).map(|_| ()).expect_err("one too many").to_string();
        assert!(printed.contains("more than 1000000 entries"), "{printed}");
        assert!(printed.lines().count() < 20 && printed.len() < 4000, "the message is short");
        assert!(begun.elapsed() < Duration::from_secs(5), "{:?}", begun.elapsed());
    }
}

#[test]
fn brackets_stand_so_deep_and_no_deeper() {
    let nested = |depth: usize| {
        let pattern = "Checker(a: ".repeat(depth) + "0.5" + &")".repeat(depth);
        let text = format!("(objects: {{ \"a\": (shape: Sphere(), material: (color: {pattern})) }})");
        parse("a.ron", &text).map(|_| ()).map_err(|faults| faults.to_string())
    };
    assert_eq!(nested(20), Ok(()));
    for depth in [100, 1000, 100_000] {
        let printed = nested(depth).expect_err("too deep");
        assert!(printed.contains("nested too deeply") && printed.contains("about 60 deep"), "{printed}");
        assert!(printed.len() < 4000, "the message is short");
    }
    // Parents are no brackets: chains of them may be long.
    let chain = (0..20_000).map(|index| {
        let parent = if index == 0 { String::new() } else { format!(", parent: \"{}\"", index - 1) };
        format!("\"{index}\": (shape: Group{parent}),")
    });
    let chain: String = chain.collect();
    assert!(parse("a.ron", &format!("(objects: {{ {chain} }})")).is_ok());
}

/// A pipe that nobody writes to is not waited for.
#[cfg(unix)]
#[test]
fn assemble_does_not_wait_for_pipes() {
    let folder = folder();
    let made = std::process::Command::new("mkfifo").arg(folder.path().join("f_00.png")).status();
    assert!(made.expect("a command").success());
    for of in [&[][..], &["--of", "ball.ron"]] {
        let printed = refused(folder.path(), &[&["assemble", "f_##.png", "-o", "f.gif"], of].concat());
        assert!(
            printed.contains("\n  frame 0: damaged: it is a device or a pipe, not a regular file\n"),
            "{printed}"
        );
    }
}

/// Runs `kinora` by a shell that has limited it first, and returns its exit code and what it prints.
#[cfg(target_os = "linux")]
fn limited(folder: &Path, limit: &str, arguments: &[&str]) -> (Option<i32>, String) {
    let mut command = std::process::Command::new("sh");
    command.args(["-c", &format!("{limit}; exec \"$@\""), "sh"]);
    let binary = assert_cmd::cargo::cargo_bin("kinora");
    let done = command.arg(binary).args(arguments).current_dir(folder).output().expect("a shell");
    (done.status.code(), stderr(&done))
}

/// The system would end the program where a file becomes larger than it may.
#[cfg(target_os = "linux")]
#[test]
fn file_size_limits_end_the_run_with_an_error() {
    let folder = folder();
    let before = crate::command::contents(folder.path());
    for outputs in
        [&["-o", "a.y4m"][..], &["-o", "a.gif"], &["-o", "a.mp4"], &["-o", "f_##.ppm"], &["-o", "f_##.exr"]]
    {
        let arguments = [&["render", "ball.ron", "-s", "320x180", "--bits", "16"], outputs].concat();
        let (code, printed) = limited(folder.path(), "ulimit -f 4", &arguments);
        assert_eq!(code, Some(3), "{outputs:?}: {printed}");
        assert!(printed.contains("error: cannot write ") && printed.contains("ulimit -f"), "{printed}");
        assert!(crate::command::contents(folder.path()) == before, "{outputs:?} leaves something");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn errors_contain_the_reason_of_the_system() {
    let folder = folder();
    // Each animation has its file open until the end.
    let outputs = ["a.mp4", "a.apng", "a.webp", "a.y4m"].map(|name| ["-o", name]).concat();
    let arguments = [&["render", "ball.ron"], &outputs[..]].concat();
    let (code, printed) = limited(folder.path(), "ulimit -n 5", &arguments);
    assert_eq!(code, Some(3), "{printed}");
    assert!(printed.contains("cannot write a.webp: Too many open files"), "{printed}");
    let done = run(folder.path(), &["render", "ball.ron", "-o", "/proc/a.gif"]);
    let printed = stderr(&done);
    // Trying again does not help.
    assert_eq!(done.status.code(), Some(2), "{printed}");
    assert!(
        printed.contains("cannot write /proc: No such file or directory") && printed.contains("-o"),
        "{printed}"
    );
}

/// JSON takes far more memory than bytes once it is parsed. Text between quotes does not.
#[cfg(target_os = "linux")]
#[test]
fn scenes_beyond_memory_are_refused_in_advance() {
    let folder = folder();
    let path = folder.path();
    let scene = |name: &str, member: &str| {
        fs::write(
            path.join("scene.gltf"),
            format!("{{\"asset\":{{\"version\":\"2.0\"}},\"{name}\":{member}}}"),
        )
        .expect("a disk");
    };
    write(path, "scene.ron", "objects: { \"robot\": (shape: Scene(\"scene.gltf\")) }");
    scene("x", &format!("[{}0]", "[0],".repeat(2 << 20)));
    let printed = refused_within(700_000, path, &["check", "scene.ron"]);
    assert!(printed.contains(" of memory, but only "), "{printed}");
    scene("extras", &format!("\"{}\"", "x".repeat(8 << 20)));
    let (code, printed) = limited(path, "ulimit -v 700000", &["check", "scene.ron"]);
    assert_eq!(code, Some(0), "{printed}");
}

/// Every joint knows the transforms of all nodes above it, which are stored once.
#[cfg(target_os = "linux")]
#[test]
fn deep_skeletons_take_little_memory() {
    use base64::Engine;
    let folder = folder();
    let path = folder.path();
    let mut data: Vec<u8> =
        [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0].iter().flat_map(|v| v.to_le_bytes()).collect();
    data.extend([0; 12]);
    data.extend([1.0f32, 0.0, 0.0, 0.0].repeat(3).iter().flat_map(|v| v.to_le_bytes()));
    let uri = format!("data:;base64,{}", base64::engine::general_purpose::STANDARD.encode(&data));
    let count = 8000;
    let nodes: Vec<String> = (0..count)
        .map(|index| match index {
            0 => r#"{"mesh":0,"skin":0}"#.to_owned(),
            index if index + 1 < count => format!(r#"{{"children":[{}]}}"#, index + 1),
            _ => "{}".to_owned(),
        })
        .collect();
    let joints: Vec<String> = (1..count).map(|joint| joint.to_string()).collect();
    let text = format!(
        r#"{{"asset":{{"version":"2.0"}},"buffers":[{{"byteLength":{},"uri":"{uri}"}}],
        "bufferViews":[{{"buffer":0,"byteLength":36}},{{"buffer":0,"byteOffset":36,"byteLength":12}},{{"buffer":0,"byteOffset":48,"byteLength":48}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"type":"VEC3","count":3}},
            {{"bufferView":1,"componentType":5121,"type":"VEC4","count":3}},{{"bufferView":2,"componentType":5126,"type":"VEC4","count":3}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0,"JOINTS_0":1,"WEIGHTS_0":2}}}}]}}],
        "skins":[{{"joints":[{}]}}],"nodes":[{}]}}"#,
        data.len(),
        joints.join(","),
        nodes.join(",")
    );
    fs::write(path.join("scene.gltf"), text).expect("a disk");
    write(path, "scene.ron", "objects: { \"robot\": (shape: Scene(\"scene.gltf\")) }");
    let (code, printed) = limited(path, "ulimit -v 1000000", &["check", "scene.ron"]);
    assert_eq!(code, Some(0), "{printed}");
}
