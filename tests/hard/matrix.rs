//! The pictures of the hard-case matrix: the textbook shows its errors, ours none. The table itself is tried beside its
//! code, in `src/accuracy/hard_cases/`.

use kinora::accuracy::hard_cases::pictures;

/// Pixels that show nothing, or no number, in the left and in the right half.
fn red(picture: &image::RgbImage) -> [usize; 2] {
    let half = picture.width() / 2;
    let is_red = |pixel: &image::Rgb<u8>| pixel[0] > 150 && pixel[1] < 60;
    let (left, right): (Vec<_>, Vec<_>) =
        picture.enumerate_pixels().filter(|(_, _, pixel)| is_red(pixel)).partition(|(x, ..)| *x < half);
    [left.len(), right.len()]
}

#[test]
fn pictures_show_textbook_errors_and_no_errors_of_kinora() {
    let folders = [(); 2].map(|()| tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).expect("a folder"));
    let [first, again] = folders.each_ref().map(|folder| pictures::write(folder.path()).expect("pictures"));
    assert_eq!(first.len(), 6);
    for (a, b) in first.iter().zip(&again) {
        assert!(std::fs::read(a).expect("a file") == std::fs::read(b).expect("a file"), "{a:?} twice");
    }
    for (name, least) in [("edges", 100), ("pole", 1000)] {
        let path = first.iter().find(|path| path.ends_with(format!("{name}.png"))).expect("the picture");
        let [textbook, ours] = red(&image::open(path).expect("a picture").to_rgb8());
        assert!(textbook >= least && ours == 0, "{name}: {textbook} and {ours} pixels");
    }
}
