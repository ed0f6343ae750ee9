//! The message about entries that cannot be values: those that stand for several objects.

use super::super::fault::Fault;
use super::super::node::Node;
use std::ops::Range;

/// Reports `Repeat` or `template` at a place where it is not expanded: in a named value.
pub fn report_misplaced(node: Node<'_>, place: Range<usize>, what: &str) {
    let title = format!("`{what}` cannot be in a value, because it stands for several objects or lights");
    let fault = Fault::new(place, title, "not expanded here");
    node.fault(fault.help("write it in `objects`, `lights` or a template; its fields may use values"));
}
