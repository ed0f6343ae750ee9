//! Decodes the `count` and the `step` of `Repeat`.

use super::super::fault::Fault;
use super::super::node::{Node, NodeContent};
use super::super::syntax::MAX_ENTRIES;
use super::expression::{Expression, INDICES, Operator};
use super::number::Number;
use super::parts::{Part, is_expression};
use super::scope::Indices;
use super::state::{Context, State};
use std::ops::Range;

/// The numbers of copies along one, two or three indices.
#[derive(Clone, Copy, Debug)]
pub struct Count {
    numbers: [u32; 3],
    pub dimensions: u8,
}

impl Count {
    /// The indices of all copies. The last index counts fastest.
    pub fn copies(self) -> impl Iterator<Item = Indices> {
        let [a, b, c] = self.numbers;
        let dimensions = self.dimensions;
        (0..a).flat_map(move |i| {
            (0..b).flat_map(move |j| (0..c).map(move |k| Indices { numbers: [i, j, k], dimensions }))
        })
    }
}

/// `12`, `"=2*n"`, `(3, 4)` or `(3, 4, 5)`.
pub fn count(state: &State<'_>, node: Node<'_>, context: &Context<'_>) -> Option<Count> {
    state.field(node, "count", context, |node| written_count(state, node, context))
}

fn written_count(state: &State<'_>, node: Node<'_>, context: &Context<'_>) -> Option<Count> {
    let items = match node.content()? {
        NodeContent::Tuple(items) if node.word().is_empty() && matches!(items.len(), 2 | 3) => items,
        NodeContent::Plain => vec![node],
        _ => {
            node.expected("a number of copies, or two or three in ( )");
            return None;
        }
    };
    let dimensions = items.len() as u8;
    let counts: Vec<_> = items.into_iter().map(|item| whole(state, item, context)).collect();
    let counts = counts.into_iter().collect::<Option<Vec<_>>>()?;
    let total: u64 = counts.iter().map(|count| u64::from(*count)).product();
    if total > MAX_ENTRIES as u64 {
        node.fault(Fault::new(
            node.span(),
            format!("more than {MAX_ENTRIES} copies"),
            format!("makes {total}"),
        ));
        return None;
    }
    let mut numbers = [1; 3];
    numbers.iter_mut().zip(counts).for_each(|(number, count)| *number = count);
    Some(Count { numbers, dimensions })
}

fn whole(state: &State<'_>, node: Node<'_>, context: &Context<'_>) -> Option<u32> {
    let what = format!("a whole number from 0 to {MAX_ENTRIES}");
    let Some(expression) = state.operand(node, context.used) else {
        // An expression with a fault has been reported.
        if !is_expression(node.text()) {
            node.expected(what);
        }
        return None;
    };
    let value = state.number(&expression, context)?.to_f64();
    if value.fract() == 0.0 && (0.0..=MAX_ENTRIES as f64).contains(&value) {
        return Some(value as u32);
    }
    let mut fault = node.mismatch(what);
    if !is_expression(node.text()) {
        node.fault(fault);
        return None;
    }
    fault.name_field("count");
    state.fault(fault.label(format!("its value is {value}")), context.used);
    None
}

/// The shift from copy to copy along each index.
pub struct Steps {
    /// Along x, y and z, for each index.
    shifts: Vec<[Expression; 3]>,
    pub place: Range<usize>,
}

/// `(x, y, z)` for one index; along x, y and z for three; or such a vector for each index, in ( ).
pub fn steps(state: &State<'_>, node: Node<'_>, dimensions: u8, context: &Context<'_>) -> Option<Steps> {
    let shifts =
        state.field(node, "step", context, |node| written_shifts(state, node, dimensions, context))?;
    Some(Steps { shifts, place: node.span() })
}

fn written_shifts(
    state: &State<'_>,
    node: Node<'_>,
    dimensions: u8,
    context: &Context<'_>,
) -> Option<Vec<[Expression; 3]>> {
    let wrong = || {
        let what = match dimensions {
            1 => "a vector (x, y, z)",
            2 => "a vector (x, y, z) for each index, in ( )",
            _ => "steps along x, y and z in ( ), or a vector for each index",
        };
        node.expected(what);
    };
    let numbers = |items: &[Node<'_>]| {
        let items: Vec<_> = items.iter().map(|item| state.operand(*item, context.used)).collect();
        let items =
            items.into_iter().collect::<Option<Vec<_>>>().and_then(|items| <[_; 3]>::try_from(items).ok());
        if items.is_none() {
            wrong();
        }
        items
    };
    let items = tuple(node, wrong)?;
    let is_vector = !items.iter().any(|item| item.opens_with('('));
    let zero = || Expression::Number(Number::whole(0));
    Some(match (dimensions, is_vector) {
        (1, true) => vec![numbers(&items)?],
        (3, true) => {
            let [x, y, z] = numbers(&items)?;
            vec![[x, zero(), zero()], [zero(), y, zero()], [zero(), zero(), z]]
        }
        (_, false) if items.len() == usize::from(dimensions) => {
            let shifts = items.iter().map(|item| numbers(&tuple(*item, wrong)?));
            shifts.collect::<Option<Vec<_>>>()?
        }
        _ => {
            wrong();
            return None;
        }
    })
}

fn tuple<'t>(node: Node<'t>, wrong: impl Fn()) -> Option<Vec<Node<'t>>> {
    match node.content()? {
        NodeContent::Tuple(items) if node.word().is_empty() => Some(items),
        _ => {
            wrong();
            None
        }
    }
}

impl Steps {
    /// The expression of a coordinate of a copy, whose first copy has it at `start`.
    pub fn coordinate(&self, axis: usize, start: Expression) -> Expression {
        let place = &self.place;
        let terms = self.shifts.iter().zip(INDICES).filter_map(|(shift, index)| {
            let step = shift.get(axis).filter(|step| !is_zero(step))?;
            let index = Expression::Name(index.to_owned(), place.clone());
            Some(binary(Operator::Multiply, index, step.clone(), place))
        });
        terms.fold(start, |sum, term| match is_zero(&sum) {
            true => term,
            false => binary(Operator::Add, sum, term, place),
        })
    }

    /// A translation that is not in the file: the shift alone.
    pub fn translation<'s>(&self) -> Vec<Part<'s>> {
        let made = |text: &str| Part::Made(text.to_owned(), self.place.clone());
        let coordinate = |axis| {
            Part::Value(self.coordinate(axis, Expression::Number(Number::whole(0))), self.place.clone())
        };
        vec![
            made("translation: ("),
            coordinate(0),
            made(", "),
            coordinate(1),
            made(", "),
            coordinate(2),
            made("), "),
        ]
    }
}

fn is_zero(expression: &Expression) -> bool {
    matches!(expression, Expression::Number(number) if number.is_zero())
}

fn binary(operator: Operator, left: Expression, right: Expression, place: &Range<usize>) -> Expression {
    Expression::Binary(operator, Box::new(left), Box::new(right), place.clone())
}
