//! Functions of angles in degrees. Those of multiples of 30 and 45 degrees are exact where they are fractions, and
//! rounded once elsewhere.

use super::number::Number;
use crate::base::math::Angle;
use std::f64::consts::FRAC_1_SQRT_2;

/// The roots of 3/4, 1/3 and 3, each the nearest `f64`.
const ROOT_OF_3_QUARTERS: f64 = 0.866_025_403_784_438_6;
const ROOT_OF_THIRD: f64 = 0.577_350_269_189_625_7;
const ROOT_OF_3: f64 = 1.732_050_807_568_877_2;

/// The smallest step of the tables in degrees.
const STEP: i32 = 15;

/// Steps of a whole turn.
const TURN: i32 = 360 / STEP;

/// Steps of the angles from 0 to 90 degrees whose sine is in the table.
const KNOWN: [i32; 5] = [0, 2, 3, 4, 6];

/// The angle as a number of steps within one turn, if it is a whole one.
fn steps(angle: Number) -> Option<i32> {
    let turn = Number::whole(360);
    let rest = match angle {
        Number::Exact(value) if value.is_integer() => angle.modulo(turn).to_f64(),
        // fmod is exact.
        Number::Float(value) => libm::fmod(value, 360.0),
        Number::Exact(_) => return None,
    };
    let is_whole = libm::fmod(rest, f64::from(STEP)) == 0.0;
    is_whole.then(|| (rest as i32 / STEP).rem_euclid(TURN))
}

/// The sine of a number of steps within one turn, if it is in the table.
fn known_sine(steps: i32) -> Option<Number> {
    match steps {
        0 => Some(Number::whole(0)),
        2 => Some(Number::whole(1).over(Number::whole(2))),
        3 => Some(Number::Float(FRAC_1_SQRT_2)),
        4 => Some(Number::Float(ROOT_OF_3_QUARTERS)),
        6 => Some(Number::whole(1)),
        7..=12 => known_sine(12 - steps),
        13..TURN => known_sine(steps - 12).map(Number::negated),
        _ => None,
    }
}

pub fn sine(angle: Number) -> Number {
    let known = steps(angle).and_then(known_sine);
    known.unwrap_or_else(|| Number::Float(Angle(angle.to_f64()).cos_sin().y))
}

pub fn cosine(angle: Number) -> Number {
    let known = steps(angle).and_then(|steps| known_sine((steps + TURN / 4) % TURN));
    known.unwrap_or_else(|| Number::Float(Angle(angle.to_f64()).cos_sin().x))
}

/// None where the tangent is infinite.
pub fn tangent(angle: Number) -> Option<Number> {
    match steps(angle).map(|steps| steps % (TURN / 2)) {
        Some(0) => Some(Number::whole(0)),
        Some(2) => Some(Number::Float(ROOT_OF_THIRD)),
        Some(3) => Some(Number::whole(1)),
        Some(4) => Some(Number::Float(ROOT_OF_3)),
        Some(6) => None,
        Some(8) => Some(Number::Float(-ROOT_OF_3)),
        Some(9) => Some(Number::whole(-1)),
        Some(10) => Some(Number::Float(-ROOT_OF_THIRD)),
        _ => {
            let (cos, sin) = Angle(angle.to_f64()).cos_sin().into();
            (cos != 0.0).then_some(Number::Float(sin / cos))
        }
    }
}

/// The angle from -90 to 90 degrees with this sine. None if there is none.
pub fn arc_sine(ratio: Number) -> Option<Number> {
    let value = ratio.to_f64();
    if !(-1.0..=1.0).contains(&value) {
        return None;
    }
    let known = arc_of_known(value.abs()).map(|angle| if value < 0.0 { -angle } else { angle });
    Some(known.map_or_else(|| degrees(libm::asin(value)), |angle| Number::whole(angle.into())))
}

/// The angle from 0 to 180 degrees with this cosine. None if there is none.
pub fn arc_cosine(ratio: Number) -> Option<Number> {
    let value = ratio.to_f64();
    if !(-1.0..=1.0).contains(&value) {
        return None;
    }
    let known = arc_of_known(value.abs()).map(|angle| if value < 0.0 { 90 + angle } else { 90 - angle });
    Some(known.map_or_else(|| degrees(libm::acos(value)), |angle| Number::whole(angle.into())))
}

/// The angle from 0 to 90 degrees with this sine, if the table has it.
fn arc_of_known(value: f64) -> Option<i32> {
    let is_it = |steps: &i32| known_sine(*steps).is_some_and(|sine| sine.to_f64() == value);
    KNOWN.into_iter().find(is_it).map(|steps| steps * STEP)
}

/// The angle of the direction (x, y), above -180 and up to 180 degrees. 0 for (0, 0).
pub fn arc_tangent(y: Number, x: Number) -> Number {
    let (up, right) = (y.to_f64(), x.to_f64());
    let whole = |angle: i128| Number::whole(if up < 0.0 { -angle } else { angle });
    match (up == 0.0, right == 0.0) {
        (true, _) => whole(if right < 0.0 { 180 } else { 0 }),
        (_, true) => whole(90),
        _ if up.abs() == right.abs() => whole(if right < 0.0 { 135 } else { 45 }),
        _ => degrees(libm::atan2(up, right)),
    }
}

fn degrees(radians: f64) -> Number {
    Number::Float(Angle::from_radians(radians).0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn common_angles_are_exact() {
        let half = Number::whole(1).over(Number::whole(2));
        for turn in [-720, -360, 0, 360] {
            let at = |angle: i128| Number::whole(angle + turn);
            assert_eq!([30, 150].map(|angle| sine(at(angle))), [half; 2]);
            assert_eq!([210, 330].map(|angle| sine(at(angle))), [half.negated(); 2]);
            assert_eq!([60, 300].map(|angle| cosine(at(angle))), [half; 2]);
            assert_eq!([90, 180, 270].map(|angle| sine(at(angle))), [1, 0, -1].map(Number::whole));
            assert_eq!(
                [45, 225, 135, 0].map(|angle| tangent(at(angle))),
                [1, 1, -1, 0].map(|n| Some(Number::whole(n)))
            );
            assert_eq!(tangent(at(270)), None);
        }
        assert_eq!(sine(Number::Float(30.0)), half);
        assert_eq!(sine(Number::Float(-30.0)), half.negated());
        for (ratio, sine, cosine) in
            [(half, 30, 60), (half.negated(), -30, 120), (Number::whole(-1), -90, 180)]
        {
            assert_eq!(arc_sine(ratio), Some(Number::whole(sine)));
            assert_eq!(arc_cosine(ratio), Some(Number::whole(cosine)));
        }
        let angle = |y, x| arc_tangent(Number::whole(y), Number::whole(x));
        assert_eq!(
            [angle(2, 2), angle(2, -2), angle(-2, -2), angle(-1, 0)],
            [45, 135, -135, -90].map(Number::whole)
        );
        assert_eq!([angle(0, 0), angle(0, -1)], [0, 180].map(Number::whole));
    }

    #[test]
    fn tables_agree_with_the_functions() {
        let near = |a: Number, b: f64| assert!((a.to_f64() - b).abs() < 1e-15, "{a:?} {b}");
        for steps in 0..TURN {
            let angle = f64::from(steps * STEP);
            let radians = angle * (std::f64::consts::PI / 180.0);
            near(sine(Number::Float(angle)), libm::sin(radians));
            near(cosine(Number::Float(angle)), libm::cos(radians));
            if let Some(tangent) = tangent(Number::Float(angle)) {
                assert!((tangent.to_f64() - libm::tan(radians)).abs() < 1e-14, "{angle}");
            }
        }
    }
}
