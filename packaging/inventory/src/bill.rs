//! The bill of materials, in the JSON of CycloneDX 1.5.

use crate::crates::Crate;
use serde_json::{Value, json};

/// The document. It has neither a time nor a serial number, so the same release has the same bill.
pub fn document(crates: &[Crate]) -> Value {
    let [program, libraries @ ..] = crates else { return Value::Null };
    let dependencies = crates.iter().map(|known| {
        let uses: Vec<_> = known.uses.iter().map(|(name, version)| package_url(name, version)).collect();
        json!({ "ref": package_url(&known.name, &known.version), "dependsOn": uses })
    });
    json!({
        "bomFormat": "CycloneDX",
        "specVersion": "1.5",
        "version": 1,
        "metadata": { "component": component(program, "application") },
        "components": libraries.iter().map(|known| component(known, "library")).collect::<Vec<_>>(),
        "dependencies": dependencies.collect::<Vec<_>>(),
    })
}

fn component(known: &Crate, kind: &str) -> Value {
    let url = package_url(&known.name, &known.version);
    let mut component = json!({
        "type": kind,
        "bom-ref": url,
        "name": known.name,
        "version": known.version,
    });
    if let Some(licence) = &known.licence {
        component["licenses"] = json!([{ "expression": licence }]);
    }
    if let Some(checksum) = &known.checksum {
        component["hashes"] = json!([{ "alg": "SHA-256", "content": checksum }]);
    }
    component["purl"] = json!(url);
    component
}

/// The package URL of a crate. Versions may have a `+`, which URLs escape.
fn package_url(name: &str, version: &str) -> String {
    format!("pkg:cargo/{name}@{}", version.replace('+', "%2B"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::crates;

    #[test]
    fn every_reference_names_a_component() {
        let bill = document(&crates::tests::some());
        assert_eq!((&bill["bomFormat"], &bill["specVersion"]), (&json!("CycloneDX"), &json!("1.5")));
        let list = |name: &str| bill[name].as_array().cloned().unwrap_or_default();
        let mut known: Vec<_> =
            list("components").iter().map(|component| component["bom-ref"].clone()).collect();
        known.push(bill["metadata"]["component"]["bom-ref"].clone());
        assert_eq!(known, ["pkg:cargo/a@1.0.0", "pkg:cargo/b@2.0.0", "pkg:cargo/kinora@0.1.0"]);
        for dependency in list("dependencies") {
            assert!(known.contains(&dependency["ref"]), "{dependency}");
            let uses = dependency["dependsOn"].as_array().cloned().unwrap_or_default();
            assert!(uses.iter().all(|used| known.contains(used)), "{dependency}");
        }
        assert_eq!(bill["components"][0]["hashes"][0]["content"], "0a");
        assert_eq!(bill["components"][1]["licenses"], Value::Null);
    }

    #[test]
    fn urls_are_escaped() {
        assert_eq!(package_url("a", "1.0.0+git"), "pkg:cargo/a@1.0.0%2Bgit");
    }
}
