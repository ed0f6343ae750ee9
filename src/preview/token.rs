//! The secret part of the address: who does not know it sees nothing.

use std::io;

/// Bytes of the secret.
const BYTES: usize = 24;

/// A random text from the system, safe in addresses.
pub fn random() -> io::Result<String> {
    let mut bytes = [0; BYTES];
    getrandom::fill(&mut bytes).map_err(|error| io::Error::other(error.to_string()))?;
    Ok(bytes.iter().map(|byte| format!("{byte:02x}")).collect())
}

/// Whether two texts are equal, in a time that does not depend on where they differ.
pub fn is_same(one: &str, other: &str) -> bool {
    let differences = one.bytes().zip(other.bytes()).fold(0, |all, (a, b)| all | (a ^ b));
    one.len() == other.len() && std::hint::black_box(differences) == 0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tokens_are_long_and_differ() {
        let (one, other) = (random().expect("random bytes"), random().expect("random bytes"));
        assert_eq!(one.len(), 2 * BYTES);
        assert!(one != other && one.bytes().all(|byte| byte.is_ascii_hexdigit()));
        assert!(
            is_same(&one, &one) && !is_same(&one, &other) && !is_same(&one, &one[1..]) && !is_same("", "a")
        );
    }
}
