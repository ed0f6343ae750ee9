//! Names for what files bring, made unique.

use std::collections::{HashMap, HashSet};

/// The names that are taken.
#[derive(Default)]
pub struct UniqueNames {
    taken: HashSet<String>,
    /// For each name, the number that its next namesake gets.
    next: HashMap<String, u64>,
}

impl UniqueNames {
    /// Takes these names.
    pub fn new<'n>(taken: impl Iterator<Item = &'n str>) -> Self {
        Self { taken: taken.map(str::to_owned).collect(), next: HashMap::new() }
    }

    /// Takes a name. If it is taken already, it gets a number: `arm_2`, `arm_3`.
    pub fn take(&mut self, name: String) -> String {
        if self.taken.insert(name.clone()) {
            return name;
        }
        let next = self.next.entry(name.clone()).or_insert(2);
        loop {
            let numbered = format!("{name}_{next}");
            *next += 1;
            if self.taken.insert(numbered.clone()) {
                return numbered;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_get_the_next_free_number() {
        let mut names = UniqueNames::new(["arm", "arm_3"].into_iter());
        let taken = ["arm", "leg", "arm", "arm_2", "leg"].map(|name| names.take(name.to_owned()));
        assert_eq!(taken, ["arm_2", "leg", "arm_4", "arm_2_2", "leg_2"]);
    }
}
