//! The motion of a double pendulum: two equal point masses on massless rods of one metre.

/// Gravity in metres per second squared.
pub const GRAVITY: f64 = 9.81;

/// Angles of both rods from the downward direction in radians, and their angular velocities.
pub type State = [f64; 4];

/// The derivative of a state, from the Lagrangian (Landau, Lifshitz, *Mechanics*, section 5).
fn derivative([a, b, u, v]: State) -> State {
    let (sin, cos) = (libm::sin(a - b), libm::cos(a - b));
    let (pull_a, pull_b) =
        (-2.0 * GRAVITY * libm::sin(a) - sin * v * v, -GRAVITY * libm::sin(b) + sin * u * u);
    // 2 u' + cos v' = pull_a and cos u' + v' = pull_b.
    let determinant = 2.0 - cos * cos;
    [u, v, (pull_a - cos * pull_b) / determinant, (2.0 * pull_b - cos * pull_a) / determinant]
}

/// A step of `h` seconds of the classical Runge-Kutta method of fourth order.
pub fn step(state: State, h: f64) -> State {
    let along = |by: State, share: f64| std::array::from_fn(|i| state[i] + share * h * by[i]);
    let k1 = derivative(state);
    let k2 = derivative(along(k1, 0.5));
    let k3 = derivative(along(k2, 0.5));
    let k4 = derivative(along(k3, 1.0));
    std::array::from_fn(|i| state[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]))
}
