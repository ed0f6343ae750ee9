//! Writes single values into the user's file; comments and layout stay.

use super::places;

/// The text with a value replaced, or added at the end of the entries that hold it.
///
/// # Errors
/// If the file has no such part.
pub fn with_value(text: &str, names: &[&str], value: &str) -> Result<String, String> {
    let mut changed = text.to_owned();
    if let Some(span) = places::find(text, names) {
        changed.replace_range(span, value);
        return Ok(changed);
    }
    let missing = || format!("the file has no `{}`; it may be in an included file", names.join("`, `"));
    let (field, outer) = names.split_last().ok_or_else(missing)?;
    let holder = places::find(text, outer).ok_or_else(missing)?;
    let Some((at, needs_comma)) = places::end_of_entries(text, holder.clone()) else {
        return Err(format!("`{}` has no fields", outer.join("`, `")));
    };
    let is_first = text[..at].ends_with(['(', '{', '[']);
    let before = match (needs_comma, is_first) {
        (true, _) => ", ",
        (false, true) => "",
        (false, false) => " ",
    };
    changed.insert_str(at, &format!("{before}{field}: {value}"));
    Ok(changed)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "(\n    // The sun.\n    lights: { \"sun\": Point(position: (1,  2, 3) /* here */, \
                        intensity: 0.5), \"b\": Point(), \"c\": Point(on: true,) },\n)\n";

    #[test]
    fn exactly_the_value_changes() {
        let set = |names: &[&str], value: &str| with_value(TEXT, names, value);
        let changed = set(&["lights", "sun", "intensity"], "0.75").expect("changed");
        assert_eq!(changed, TEXT.replace("0.5", "0.75"));
        let changed = set(&["lights", "sun", "position"], "(4, 5, 6)").expect("changed");
        assert_eq!(changed, TEXT.replace("(1,  2, 3)", "(4, 5, 6)"));
    }

    #[test]
    fn missing_fields_are_added() {
        let set = |names: &[&str], value: &str| with_value(TEXT, names, value);
        let changed = set(&["lights", "sun", "on"], "false").expect("changed");
        assert_eq!(changed, TEXT.replace("intensity: 0.5", "intensity: 0.5, on: false"));
        let changed = set(&["lights", "b", "on"], "false").expect("changed");
        assert_eq!(changed, TEXT.replace("\"b\": Point()", "\"b\": Point(on: false)"));
        let changed = set(&["lights", "c", "intensity"], "2").expect("changed");
        assert_eq!(changed, TEXT.replace("on: true,", "on: true, intensity: 2"));
        assert!(set(&["lights", "moon", "on"], "false").is_err());
        assert!(set(&["lights", "sun", "intensity", "x"], "1").is_err());
    }
}
