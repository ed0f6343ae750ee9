//! Functions of expressions. Angles are in degrees, as everywhere in the file.

use super::number::Number;
use crate::base::math::Angle;

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
    function("sin", 1, 1, |n| Ok(Number::Float(cos_sin(n).1))),
    function("cos", 1, 1, |n| Ok(Number::Float(cos_sin(n).0))),
    function("tan", 1, 1, |n| match cos_sin(n) {
        (0.0, _) => Err("the tangent is infinite here"),
        (cos, sin) => Ok(Number::Float(sin / cos)),
    }),
    function("asin", 1, 1, |n| inverse(n, libm::asin)),
    function("acos", 1, 1, |n| inverse(n, libm::acos)),
    function("atan2", 2, 2, |n| Ok(degrees(libm::atan2(float(n, 0), float(n, 1))))),
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

fn float(arguments: &[Number], index: usize) -> f64 {
    arguments.get(index).map_or(f64::NAN, |number| number.to_f64())
}

/// Exact for the squares of whole numbers up to 2^53.
fn square_root(value: Number) -> Number {
    let root = value.to_f64().sqrt();
    let whole = Number::whole(root as i128);
    if whole.times(whole) == value { whole } else { Number::Float(root) }
}

/// (cosine, sine), exact at quarter turns.
fn cos_sin(arguments: &[Number]) -> (f64, f64) {
    Angle(float(arguments, 0)).cos_sin().into()
}

/// An angle in degrees, from a ratio between -1 and 1.
fn inverse(arguments: &[Number], function: fn(f64) -> f64) -> Result<Number, &'static str> {
    let ratio = float(arguments, 0);
    if (-1.0..=1.0).contains(&ratio) {
        return Ok(degrees(function(ratio)));
    }
    Err("its argument must be from -1 to 1")
}

fn degrees(radians: f64) -> Number {
    Number::Float(Angle::from_radians(radians).0)
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
    let (a, b) = (only(arguments), only(arguments.get(1..).unwrap_or_default()));
    if b.is_zero() {
        return Err("division by 0");
    }
    let whole = a.over(b).mapped(|value| value.floor(), f64::floor);
    Ok(a.minus(b.times(whole)))
}
