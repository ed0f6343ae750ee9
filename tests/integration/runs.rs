//! Runs beside and after each other in one folder.

use crate::command::{contents, folder, kinora, refused};
use std::fs;

#[test]
fn shards_make_what_one_run_makes() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    kinora(
        folder.path(),
        &["render", "ball.ron", "-o", "one/f_##.png", "-o", "one/f_##.exr", "-o", "one/a.gif"],
    );
    std::thread::scope(|scope| {
        for shard in ["1/5", "2/5", "3/5", "4/5", "5/5"] {
            let outputs = ["-o", "all/f_##.png", "-o", "all/f_##.exr"];
            let arguments = [&["render", "ball.ron", "--shard", shard], &outputs[..]].concat();
            let path = folder.path();
            scope.spawn(move || kinora(path, &arguments));
        }
    });
    kinora(folder.path(), &["assemble", "all/f_##.png", "-o", "all/a.gif"]);
    assert!(contents(&at("one")) == contents(&at("all")));
    assert_eq!(contents(&at("one")).len(), 25);
}

#[test]
fn shards_write_stills() {
    let folder = folder();
    let told = kinora(folder.path(), &["render", "ball.ron", "--shard", "1/1"]);
    assert!(told.contains("output/ball.gif holds all frames and is left as it is"), "{told}");
    assert!(!folder.path().join("output/ball.gif").exists());
    let told = refused(folder.path(), &["render", "ball.ron", "--shard", "1/2", "-o", "a.gif"]);
    assert!(
        told.contains("every shard would write all of a.gif") && told.contains("kinora assemble"),
        "{told}"
    );
    let told = refused(folder.path(), &["render", "ball.ron", "--shard", "3/2", "-o", "f_##.png"]);
    assert!(told.contains("such as 2/4"), "{told}");
    let told = kinora(folder.path(), &["render", "ball.ron", "--shard", "1/20", "-o", "few/f_##.png"]);
    assert_eq!(told, "shard 1/20 has no frames: there are 12 frames\n");
    assert!(!folder.path().join("few").exists());
}

#[test]
fn nothing_is_replaced_where_nothing_may_be() {
    let folder = folder();
    let refusing = |outputs: &[&str]| {
        refused(folder.path(), &[&["render", "ball.ron", "--fail-if-exists"], outputs].concat())
    };
    for name in ["f_11.png", "a.gif"] {
        fs::write(folder.path().join(name), "mine").expect("a disk");
    }
    let before = contents(folder.path());
    for outputs in [&["-o", "f_##.png"][..], &["-o", "new/f_##.png", "-o", "a.gif"]] {
        let told = refusing(outputs);
        assert!(told.contains(" is there already") && told.contains("--fail-if-exists"), "{told}");
    }
    assert!(contents(folder.path()) == before && !folder.path().join("new").exists());
    // Frames of other numbers are none of those that would be written.
    let rest = ["render", "ball.ron", "--fail-if-exists", "--frames", "0-10", "-o", "f_##.png"];
    kinora(folder.path(), &rest);
    refused(folder.path(), &rest);
    refused(folder.path(), &["render", "ball.ron", "--fail-if-exists", "--overwrite"]);
    fs::create_dir(folder.path().join("g_03.png")).expect("a disk");
    let told = refused(folder.path(), &["render", "ball.ron", "-o", "g_##.png"]);
    assert!(told.contains("g_03.png: it is a folder"), "{told}");
}
