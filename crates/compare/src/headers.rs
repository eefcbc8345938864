//! What differs in the headers of two EXR files.

use film::ExrHeader;

/// An attribute that is not the same in both files.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct AttributeDifference {
    /// The part's place in the file, from 0.
    pub part: usize,
    /// The attribute.
    pub name: String,
    /// Its value in the first file, if it is there.
    pub a: Option<String>,
    /// Its value in the second file, if it is there.
    pub b: Option<String>,
}

/// Every attribute whose type or bytes differ, part by part, in alphabetical order. Parts belong together
/// by their order.
#[must_use]
pub fn differing_attributes(a: &[ExrHeader], b: &[ExrHeader]) -> Vec<AttributeDifference> {
    let none = ExrHeader { attributes: Vec::new() };
    let mut differing = Vec::new();
    for part in 0..a.len().max(b.len()) {
        let [a, b] = [a, b].map(|headers| headers.get(part).unwrap_or(&none));
        let names = a.attributes.iter().chain(&b.attributes).map(|attribute| &attribute.name);
        let mut names: Vec<&String> = names.collect();
        names.sort();
        names.dedup();
        for name in names {
            let [one, other] = [a.get(name), b.get(name)];
            if one != other {
                let [a, b] = [one, other].map(|found| found.map(|attribute| attribute.shown()));
                differing.push(AttributeDifference { part, name: name.clone(), a, b });
            }
        }
    }
    differing
}
