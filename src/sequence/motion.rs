//! Objects that a program moves.

use super::Sequence;
use super::deformations::refresh_joints;
use super::suggest::{nearest, shortened};
use super::values::LARGEST;
use crate::base::math::{DAffine3, DVec3};
use crate::geometry::motion::Motion;
use std::error::Error;
use std::fmt::{Display, Formatter};

/// The sequence has no object of this name.
#[derive(Clone, Debug, PartialEq, Eq)]
#[warn(missing_docs)]
pub struct UnknownObject {
    /// The name that was asked for.
    pub name: String,
    /// An object with a similar name.
    pub meant: Option<String>,
}

impl Display for UnknownObject {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        write!(f, "the sequence has no object `{}`", shortened(&self.name))?;
        self.meant.as_ref().map_or(Ok(()), |meant| write!(f, "; did you mean `{}`?", shortened(meant)))
    }
}

impl Error for UnknownObject {}

#[warn(missing_docs)]
impl Sequence {
    /// Lets a program move an object: `motion` gives, for a time in seconds, the images of the x, y and z axes and of
    /// the origin. The object's own transform follows, then its parent's.
    ///
    /// `motion` must be pure: the same time gives the same map, in any order of calls and on any thread, because frames
    /// are evaluated in parallel, before any is traced, and again when they are. Then plans, the reuse of films and the
    /// recognition of existing frames work as with keys: they compare what is seen, not where it comes from. An
    /// impure motion makes a film wrong that several frames share.
    ///
    /// Numbers that are not finite or above 10^30, or a map that flattens the object, hide it at this time.
    ///
    /// # Errors
    /// The name of an object that the sequence does not have.
    pub fn drive(
        &mut self,
        object: &str,
        motion: impl Fn(f64) -> [[f64; 3]; 4] + Send + Sync + 'static,
    ) -> Result<(), UnknownObject> {
        let Some(index) = self.objects.iter().position(|known| known.name == object) else {
            let names = self.objects.iter().map(|known| known.name.as_str());
            let meant = nearest(object, names).map(str::to_owned);
            return Err(UnknownObject { name: object.to_owned(), meant });
        };
        self.objects[index].value.transform.motion = Some(Motion::new(move |time| in_range(motion(time))));
        self.refresh_carried(index);
        refresh_joints(&mut self.objects, index);
        Ok(())
    }
}

/// The map, or one that hides everything if it is outside the range of the arithmetic.
fn in_range(columns: [[f64; 3]; 4]) -> DAffine3 {
    let [x, y, z, origin] = columns.map(DVec3::from_array);
    let is_good = columns.as_flattened().iter().all(|number| number.abs() <= LARGEST);
    if is_good { DAffine3::from_cols(x, y, z, origin) } else { DAffine3::ZERO }
}
