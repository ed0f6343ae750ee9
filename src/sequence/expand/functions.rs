//! Functions of expressions. Angles are in degrees, as everywhere in the file.

use super::angles;
use super::number::Number;

/// A function, with the least and the largest number of its arguments.
#[derive(Clone, Copy)]
pub struct Function {
    pub name: &'static str,
    pub least: usize,
    pub most: usize,
    /// The value, or the reason why there is none.
    pub value: fn(&[Number]) -> Result<Number, &'static str>,
}

/// Largest number of arguments.
const MANY: usize = 100;

pub const FUNCTIONS: [Function; 14] = [
    function("sqrt", 1, 1, |n| match n.first().copied().unwrap_or(Number::Float(f64::NAN)) {
        root if root.to_f64() < 0.0 => Err("the root of a negative number does not exist"),
        root => Ok(square_root(root)),
    }),
    function("sin", 1, 1, |n| Ok(angles::sine(only(n)))),
    function("cos", 1, 1, |n| Ok(angles::cosine(only(n)))),
    function("tan", 1, 1, |n| angles::tangent(only(n)).ok_or("the tangent is infinite here")),
    function("asin", 1, 1, |n| angles::arc_sine(only(n)).ok_or("its argument must be from -1 to 1")),
    function("acos", 1, 1, |n| angles::arc_cosine(only(n)).ok_or("its argument must be from -1 to 1")),
    function("atan2", 2, 2, |n| Ok(angles::arc_tangent(only(n), second(n)))),
    function("min", 1, MANY, |n| Ok(extreme(n, |a, b| a.is_less(b)))),
    function("max", 1, MANY, |n| Ok(extreme(n, |a, b| b.is_less(a)))),
    function("abs", 1, 1, |n| {
        Ok(only(n).mapped(|value| if *value.numer() < 0 { -value } else { value }, f64::abs))
    }),
    function("floor", 1, 1, |n| Ok(only(n).mapped(|value| value.floor(), f64::floor))),
    function("ceil", 1, 1, |n| Ok(only(n).mapped(|value| value.ceil(), f64::ceil))),
    function("round", 1, 1, |n| Ok(only(n).mapped(|value| value.round(), f64::round))),
    function("mod", 2, 2, modulo),
];

const fn function(
    name: &'static str,
    least: usize,
    most: usize,
    value: fn(&[Number]) -> Result<Number, &'static str>,
) -> Function {
    Function { name, least, most, value }
}

/// The first argument, which always exists.
fn only(arguments: &[Number]) -> Number {
    arguments.first().copied().unwrap_or(Number::Float(f64::NAN))
}

/// The second argument of functions with two.
fn second(arguments: &[Number]) -> Number {
    only(arguments.get(1..).unwrap_or_default())
}

/// Exact for the squares of whole numbers up to 2^53.
fn square_root(value: Number) -> Number {
    let root = value.to_f64().sqrt();
    let whole = Number::whole(root as i128);
    if whole.times(whole) == value { whole } else { Number::Float(root) }
}

fn extreme(arguments: &[Number], is_better: impl Fn(Number, Number) -> bool) -> Number {
    arguments
        .iter()
        .copied()
        .reduce(|best, next| if is_better(next, best) { next } else { best })
        .unwrap_or(only(&[]))
}

/// The remainder with the sign of the divisor: a - b · floor(a / b).
fn modulo(arguments: &[Number]) -> Result<Number, &'static str> {
    let (a, b) = (only(arguments), second(arguments));
    if b.is_zero() { Err("division by 0") } else { Ok(a.modulo(b)) }
}
