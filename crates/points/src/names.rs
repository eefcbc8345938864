//! Which of the points' numbers a name in a scene or a filter means.

/// Names of one thing, of which programs write different ones; compared without letter case,
/// separators and the prefix `scalar_`.
const SYNONYMS: [&[&str]; 5] = [
    &["intensity", "intensities", "i"],
    &["classification", "class"],
    &["scanangle", "scananglerank"],
    &["scandirection", "scandirectionflag"],
    &["numberofreturns", "returncount"],
];
/// What CloudCompare writes before the names of attributes.
const PREFIX: &str = "scalar_";

/// The place among `names` of the one that `asked` means. The first of these rules that any name
/// meets decides, and of several names that meet it, the first in the file:
///
/// 1. the name itself;
/// 2. the name in other letter case;
/// 3. the name without letter case, blanks, underscores, hyphens, dots and colons, and without
///    `scalar_` before either: `gps_time` means `scalar_GpsTime`;
/// 4. another name of the same thing: `classification` means `class`.
pub(crate) fn find<'a>(names: impl Iterator<Item = &'a str> + Clone, asked: &str) -> Option<usize> {
    let place = |fits: &dyn Fn(&str) -> bool| names.clone().position(fits);
    place(&|name| name == asked)
        .or_else(|| place(&|name| name.eq_ignore_ascii_case(asked)))
        .or_else(|| {
            let wanted = plain(asked);
            place(&|name| plain(name) == wanted).or_else(|| {
                let same = SYNONYMS.iter().find(|same| same.contains(&wanted.as_str()))?;
                same.iter().find_map(|other| place(&|name| plain(name) == *other))
            })
        })
}

/// A name without what programs do differently.
pub(crate) fn plain(name: &str) -> String {
    let is_separator = |sign: &char| matches!(sign, ' ' | '_' | '-' | '.' | ':');
    let has_prefix = name.get(..PREFIX.len()).is_some_and(|p| p.eq_ignore_ascii_case(PREFIX));
    let name = if has_prefix && name.len() > PREFIX.len() { &name[PREFIX.len()..] } else { name };
    name.chars().filter(|sign| !is_separator(sign)).flat_map(char::to_lowercase).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_many_programs_mean_the_same() {
        let place = |names: &[&str], asked| find(names.iter().copied(), asked);
        for (asked, name) in [
            ("intensity", "scalar_Intensity"),
            ("Intensity", "scalar_intensity"),
            ("scalar_Intensity", "intensity"),
            ("INTENSITY", "intensity"),
            ("classification", "scalar_Classification"),
            ("classification", "Class"),
            ("gps_time", "scalar_GpsTime"),
            ("gps_time", "GpsTime"),
            ("GpsTime", "scalar_Gps_Time"),
            ("number_of_returns", "NumberOfReturns"),
            ("scan_angle", "ScanAngleRank"),
            ("Scalar field", "scalar_Scalar_field"),
            ("temp", "Temp"),
        ] {
            assert_eq!(place(&["other", name], asked), Some(1), "{asked} in {name}");
        }
        // A name that only begins like the prefix keeps it, and nothing is left of the prefix alone.
        for (asked, name) in [("field", "scalarfield"), ("", "scalar_"), ("tensity", "intensity")] {
            assert_eq!(place(&[name], asked), None, "{asked} in {name}");
        }
    }

    #[test]
    fn the_nearest_name_wins_then_the_first() {
        let place = |names: &[&str], asked| find(names.iter().copied(), asked);
        let names = ["scalar_Intensity", "INTENSITY", "Intensity", "intensity"];
        assert_eq!(place(&names, "intensity"), Some(3));
        assert_eq!(place(&names[..3], "intensity"), Some(1));
        assert_eq!(place(&names[..1], "intensity"), Some(0));
        assert_eq!(place(&names, "scalar_intensity"), Some(0));
        assert_eq!(place(&["class", "scalar_Classification"], "classification"), Some(1));
    }
}
