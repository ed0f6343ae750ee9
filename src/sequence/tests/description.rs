//! The examples in the description of the format.

use crate::sequence::parse;

/// Checks that a text has no faults except missing files.
fn check_example(text: &str) {
    let faults = parse("example.ron", text).err().map(|faults| faults.to_string()).unwrap_or_default();
    let missing = ["image", "mesh", "scene", "series", "table"]
        .map(|what| faults.matches(&format!("cannot read the {what}")).count());
    assert_eq!(faults.matches("error:").count(), missing.into_iter().sum::<usize>(), "{faults}");
}

/// All examples of the format's description are valid.
#[test]
fn examples_of_the_description_are_valid() {
    let description = include_str!("../../../sequences/README.md");
    let blocks: Vec<&str> =
        description.split("```ron\n").skip(1).filter_map(|rest| rest.split("```").next()).collect();
    assert!(blocks.len() >= 8, "{} examples", blocks.len());
    for block in blocks {
        if block.starts_with("intensity") {
            // One field in several notations.
            let ways = block.replace("intensity:", "}, \"x\": {intensity:");
            let lights = ways.split("}, \"x\": {").skip(1);
            for light in lights {
                check_example(&format!("(lights: {{ \"l\": Point(position: (1, 2, 3), {light}) }})"));
            }
        } else if block.starts_with('(') {
            check_example(block);
        } else if block.starts_with(char::is_uppercase) {
            // A paint.
            check_example(&format!("(default_material: (color: {block}))"));
        } else {
            check_example(&format!("({block})"));
        }
    }
}
