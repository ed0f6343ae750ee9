//! Former names of fields, and names that lead to the right ones.

use super::read;
use crate::base::color::Rgb;
use crate::sequence::parse;
use crate::sequence::quality::NoiseTarget;

/// Files with former names of fields are read as before, and a note gives the file, the line and the new name.
#[test]
fn former_names_of_fields_are_read_with_a_warning() {
    let fields = |background: &str, loops: &str, samples: &str| {
        format!(
            "(\n output: ({background}: \"#f00\",\n  gif: ({loops}: 3),\n  apng: ({loops}: 4), webp: ({loops}: 5)),
              quality: (noise: 0.1, {samples}: 7),\n)"
        )
    };
    let (old, new) =
        (fields("matte", "plays", "most_samples"), fields("background_color", "loop_count", "max_samples"));
    let (old, new) = (read(&old), read(&new));
    assert_eq!((&old.output, old.quality), (&new.output, new.quality));
    assert_eq!((old.output.background_color, old.output.formats.gif.loop_count), (Rgb::X, Some(3)));
    assert_eq!(old.quality.noise, Some(NoiseTarget { error: 0.1, most: 7 }));
    assert_eq!(new.notes(), [""; 0]);
    let warning = |line: u32, what: &str, former: &str, name: &str| {
        format!(
            "dir/test.ron:{line}: {what}: the field `{former}` is now called `{name}`; the old name still works"
        )
    };
    let expected = [
        warning(2, "the output", "matte", "background_color"),
        warning(3, "`gif`", "plays", "loop_count"),
        warning(4, "`apng`", "plays", "loop_count"),
        warning(4, "`webp`", "plays", "loop_count"),
        warning(5, "the quality", "most_samples", "max_samples"),
    ];
    assert_eq!(old.notes(), expected);
}

#[test]
fn a_field_and_its_former_name_together_are_a_fault() {
    let faults = |text: &str| parse("dir/test.ron", text).expect_err("a fault").to_string();
    let both = faults("(output: (gif: (plays: 3, loop_count: 3)))");
    assert!(both.contains("`plays` is the former name of `loop_count`"), "{both}");
    assert_eq!(both.matches("error:").count(), 1, "{both}");
    let wrong = faults("(quality: (most_samples: 0))");
    assert!(wrong.contains("`most_samples`: expected a whole number from 1 to"), "{wrong}");
    let listed = faults("(quality: (most: 1))");
    assert!(listed.contains("`max_samples`") && !listed.contains("most_samples"), "{listed}");
}

#[test]
fn misspelt_former_names_and_misplaced_fields_lead_to_current_ones() {
    let faults = |text: &str| parse("dir/test.ron", text).expect_err("a fault").to_string();
    let misspelt = faults("(quality: (most_sample: 1))");
    assert!(misspelt.contains("did you mean `max_samples`?"), "{misspelt}");
    let moved = faults("(output: (plays: 2))");
    assert!(moved.contains("`plays` is now `loop_count`, a field of `gif`, `apng` and `webp`"), "{moved}");
    let misplaced = faults("(output: (loop_count: 2, sise: 1))");
    assert!(misplaced.contains("`loop_count` is a field of `gif`, `apng` and `webp`"), "{misplaced}");
    assert!(!misplaced.contains("has no field `loop_count`"), "{misplaced}");
    let empty = faults(r#"(objects: { "ball": (shape: Sphere(), material: "red") })"#);
    assert!(empty.contains("the section `materials` has no entries"), "{empty}");
}
