//! `tests/bad/NAME.ron` is refused with exactly the message of `tests/bad/NAME.txt`.

use crate::bless;
use kinora::sequence::parse;
use libtest_mimic::Failed;
use std::fs;
use std::path::Path;

pub fn check(path: &Path) -> Result<(), Failed> {
    let source = fs::read_to_string(path)?;
    // Images are found by the whole path. Messages keep the part that is the same on every machine.
    let path_text = path.to_string_lossy();
    let name = path.file_name().expect("a name").to_string_lossy();
    let Err(faults) = parse(&path_text, &source) else { return Err("it is accepted".into()) };
    let folder = path.with_file_name("").to_string_lossy().into_owned();
    let message = format!("{faults}\n").replace(&*path_text, &name).replace(&folder, "");
    // The next release has the same messages.
    let message = message.replace(concat!("Kinora ", env!("CARGO_PKG_VERSION")), "Kinora VERSION");
    let expected = path.with_extension("txt");
    if bless() {
        fs::write(&expected, message)?;
    } else if fs::read_to_string(&expected).unwrap_or_default() != message {
        return Err(format!("the message is now\n{message}").into());
    }
    Ok(())
}
