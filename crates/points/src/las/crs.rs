//! What the coordinate reference system of a LAS file says of x, y and z: whether they are degrees.
//!
//! It is stored as GeoTIFF keys or as well-known text (WKT), in variable length records of the user
//! `LASF_Projection`. Only the kind of system matters here, and its units: a geographic system has
//! longitude in x and latitude in y, whatever the order of its axes elsewhere.

use super::Record;
use crate::field::Type;
use crate::source::Seekable;
use std::io;

/// The owner of the records.
const USER: &str = "LASF_Projection";
const GEO_KEYS: u16 = 34735;
const WKT: u16 = 2112;
/// Bytes of a record that are looked at.
const MAX_BYTES: u64 = 1 << 18;

/// What a geographic system says.
#[derive(Debug, PartialEq, Default)]
pub(super) struct Geographic {
    /// Its name or number, in words.
    pub(super) name: String,
    /// Whether its angles are degrees.
    pub(super) degrees: bool,
    /// The unit of heights where it is not the metre.
    pub(super) vertical: Option<String>,
}

impl Geographic {
    /// How the file shows that x and y are degrees.
    pub(super) fn in_words(&self) -> String {
        format!("its coordinate reference system is geographic ({})", self.name)
    }

    /// What of the units may surprise.
    pub(super) fn doubts(&self) -> Option<String> {
        let system = self.in_words();
        if !self.degrees {
            return Some(format!(
                "{system}, but its angles are not degrees: x and y are left as they are; convert the file \
                 to degrees or to metres"
            ));
        }
        let unit = self.vertical.as_ref()?;
        Some(format!(
            "{system} with heights in {unit}, which stay as they are while x and y become metres; convert \
             heights to metres for true proportions"
        ))
    }
}

/// What is found of the kind of system.
enum Found {
    Geographic(Geographic),
    /// Of another kind: projected, geocentric.
    Other,
}

/// The geographic coordinate reference system of a file, if it has one. `prefers_text` is the bit of the
/// header that says that WKT counts.
pub(super) fn of(
    file: &mut Seekable<'_>,
    records: &[Record],
    prefers_text: bool,
) -> io::Result<Option<Geographic>> {
    let mut contents = |id: u16| {
        let record = records.iter().find(|record| record.is(USER, id));
        record.map(|record| file.bytes_at(record.place, record.length.min(MAX_BYTES))).transpose()
    };
    let by_keys = contents(GEO_KEYS)?.and_then(|bytes| of_keys(&bytes));
    let by_text = contents(WKT)?.and_then(|bytes| of_text(&String::from_utf8_lossy(&bytes)));
    let (first, second) = if prefers_text { (by_text, by_keys) } else { (by_keys, by_text) };
    Ok(match first.or(second) {
        Some(Found::Geographic(system)) => Some(system),
        _ => None,
    })
}

/// GeoTIFF keys: numbers of 16 bits, four a key. The numbers are those of the GeoTIFF standard (OGC 19-008).
fn of_keys(bytes: &[u8]) -> Option<Found> {
    const MODEL_TYPE: u16 = 1024;
    const GEODETIC: u16 = 2048;
    const ANGULAR_UNITS: u16 = 2054;
    const PROJECTED: u16 = 3072;
    const VERTICAL_UNITS: u16 = 4099;
    const DEGREE: u16 = 9102;
    let words: Vec<u16> =
        bytes.chunks_exact(2).map(|word| Type::U16.read::<false>(word) as u16).collect();
    let count = usize::from(*words.get(3)?);
    let keys = || words[4..].chunks_exact(4).take(count);
    // A value elsewhere than in the key itself is none of those that matter.
    let value = |id: u16| keys().find(|key| key[0] == id && key[1] == 0).map(|key| key[3]);
    let is_geographic = match value(MODEL_TYPE) {
        Some(2) => true,
        Some(1 | 3) => false,
        _ => value(GEODETIC).is_some() && value(PROJECTED).is_none(),
    };
    if !is_geographic {
        return value(MODEL_TYPE).or(value(PROJECTED)).map(|_| Found::Other);
    }
    let name = match value(GEODETIC) {
        Some(code @ 1024..32767) => format!("EPSG:{code}"),
        _ => "by its GeoTIFF keys".to_owned(),
    };
    Some(Found::Geographic(Geographic {
        name,
        degrees: value(ANGULAR_UNITS).is_none_or(|unit| unit == DEGREE),
        vertical: match value(VERTICAL_UNITS) {
            Some(9002) => Some("feet".to_owned()),
            Some(9003) => Some("US survey feet".to_owned()),
            _ => None,
        },
    }))
}

/// Well-known text, of either version. The first keyword of a system of one kind decides: in a compound or
/// bound system that is the horizontal one, and of a projected one it comes before the geographic one inside.
fn of_text(text: &str) -> Option<Found> {
    const GEOGRAPHIC: [&str; 5] = ["GEOGCS", "GEOGCRS", "GEOGRAPHICCRS", "GEODCRS", "GEODETICCRS"];
    const OTHER: [&str; 10] = [
        "PROJCS",
        "PROJCRS",
        "PROJECTEDCRS",
        "GEOCCS",
        "LOCAL_CS",
        "ENGCRS",
        "ENGINEERINGCRS",
        "VERT_CS",
        "VERTCRS",
        "FITTED_CS",
    ];
    const VERTICAL: [&str; 3] = ["VERT_CS", "VERTCRS", "VERTICALCRS"];
    let nodes = nodes(text);
    let is = |node: &Node<'_>, words: &[&str]| {
        words.iter().any(|word| node.word.eq_ignore_ascii_case(word))
    };
    let place = nodes.iter().position(|node| is(node, &GEOGRAPHIC) || is(node, &OTHER))?;
    let system = &nodes[place];
    if !is(system, &GEOGRAPHIC) {
        return Some(Found::Other);
    }
    let own = || nodes[place + 1..].iter().take_while(|node| node.depth > system.depth);
    if own().any(|node| is(node, &["CS"]) && node.name.trim().eq_ignore_ascii_case("cartesian")) {
        return Some(Found::Other);
    }
    const DEGREE: f64 = std::f64::consts::PI / 180.0;
    let mut angles =
        own().filter(|node| is(node, &["UNIT", "ANGLEUNIT"])).filter_map(|unit| unit.number);
    // Lengths of an ellipsoid, too, may have a UNIT: a degree among several is enough.
    let degrees = own().all(|node| !is(node, &["UNIT", "ANGLEUNIT"]))
        || angles.any(|factor| (factor / DEGREE - 1.0).abs() < 1e-6);
    let heights = nodes.iter().position(|node| is(node, &VERTICAL)).and_then(|place| {
        let inside = nodes[place + 1..].iter().take_while(|node| node.depth > nodes[place].depth);
        inside
            .filter(|node| is(node, &["UNIT", "LENGTHUNIT"]))
            .find(|unit| unit.number.is_some_and(|factor| factor != 1.0))
    });
    Some(Found::Geographic(Geographic {
        name: crate::meaning::printable(system.name),
        degrees,
        vertical: heights.map(|unit| crate::meaning::printable(unit.name)),
    }))
}

/// A node of well-known text: `WORD["name", number, …]`, in the order in which they begin.
struct Node<'t> {
    word: &'t str,
    /// What stands before the first comma, without quotes.
    name: &'t str,
    /// What stands after it, if it is a number.
    number: Option<f64>,
    depth: usize,
}

fn nodes(text: &str) -> Vec<Node<'_>> {
    const MOST: usize = 1 << 12;
    let mut nodes = Vec::new();
    let (mut depth, mut quoted, mut word_start) = (0usize, false, 0);
    for (at, sign) in text.char_indices() {
        match sign {
            '"' => quoted = !quoted,
            _ if quoted => (),
            '[' | '(' => {
                let rest = &text[at + 1..];
                let (name, after) = first_value(rest);
                let number =
                    after.split([',', ']', ')']).next().and_then(|word| word.trim().parse().ok());
                nodes.push(Node { word: text[word_start..at].trim(), name, number, depth });
                depth += 1;
                word_start = at + 1;
                if nodes.len() == MOST {
                    break;
                }
            }
            ']' | ')' => {
                depth = depth.saturating_sub(1);
                word_start = at + 1;
            }
            ',' => word_start = at + 1,
            _ => (),
        }
    }
    nodes
}

/// The first value of a node, without quotes, and what follows its comma.
fn first_value(rest: &str) -> (&str, &str) {
    let rest = rest.trim_start();
    if let Some(text) = rest.strip_prefix('"') {
        let (name, after) = text.split_once('"').unwrap_or((text, ""));
        return (name, after.trim_start().strip_prefix(',').unwrap_or(""));
    }
    let end = rest.find([',', ']', ')']).unwrap_or(rest.len());
    (&rest[..end], rest[end..].strip_prefix(',').unwrap_or(""))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn geographic(found: Option<Found>) -> Option<Geographic> {
        match found {
            Some(Found::Geographic(system)) => Some(system),
            _ => None,
        }
    }

    fn keys(pairs: &[[u16; 2]]) -> Option<Geographic> {
        let mut words = vec![1, 1, 0, pairs.len() as u16];
        words.extend(pairs.iter().flat_map(|&[id, value]| [id, 0, 1, value]));
        geographic(of_keys(&words.iter().flat_map(|word| word.to_le_bytes()).collect::<Vec<_>>()))
    }

    fn text(text: &str) -> Option<(String, bool, Option<String>)> {
        geographic(of_text(text)).map(|system| (system.name, system.degrees, system.vertical))
    }

    #[test]
    fn keys_tell_geographic_from_projected() {
        let wgs = keys(&[[1024, 2], [1025, 1], [2048, 4326], [2054, 9102]]).unwrap();
        assert_eq!(wgs, Geographic { name: "EPSG:4326".to_owned(), degrees: true, vertical: None });
        assert!(keys(&[[2048, 4269]]).unwrap().degrees, "without a model type");
        assert!(!keys(&[[1024, 2], [2048, 4807], [2054, 9105]]).unwrap().degrees, "grads");
        let feet = keys(&[[1024, 2], [2048, 4979], [4099, 9003]]).unwrap();
        assert_eq!(feet.vertical.as_deref(), Some("US survey feet"));
        assert_eq!(keys(&[[1024, 1], [2048, 4269], [3072, 26910]]), None, "projected");
        assert_eq!(keys(&[[2048, 4269], [3072, 26910]]), None, "projected, without a model type");
        assert_eq!(keys(&[[1024, 3], [2048, 4978]]), None, "geocentric");
        assert_eq!(keys(&[]), None);
        assert!(of_keys(&[1, 0, 1]).is_none() && of_keys(&[0; 8]).is_none(), "cut off");
    }

    const GEOGCS: &str = r#"GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563]],PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433]]"#;
    const VERT: &str = r#"VERT_CS["NAVD88 height (ftUS)",VERT_DATUM["NAVD88",2005],UNIT["US survey foot",0.304800609601219]]"#;

    #[test]
    fn text_tells_geographic_from_projected() {
        let wgs = Some(("WGS 84".to_owned(), true, None));
        assert_eq!(text(GEOGCS), wgs);
        assert_eq!(text(&format!("  {}\0", GEOGCS.replace(',', ",\n  ").replace('[', " ["))), wgs);
        assert_eq!(text(&GEOGCS.replace('[', "(").replace(']', ")")), wgs);
        let projected = format!(
            r#"PROJCS["WGS 84 / UTM zone 16N",{GEOGCS},PROJECTION["Transverse_Mercator"],UNIT["metre",1]]"#
        );
        assert_eq!(text(&projected), None);
        assert_eq!(text(&format!(r#"COMPD_CS["a",{projected},{VERT}]"#)), None);
        let compound = text(&format!(r#"COMPD_CS["PROJCS[, no]",{GEOGCS},{VERT}]"#)).unwrap();
        assert_eq!(compound, ("WGS 84".to_owned(), true, Some("US survey foot".to_owned())));
        let grads = GEOGCS.replace(r#""degree",0.0174532925199433"#, r#""grad",0.015707963267949"#);
        assert!(!text(&grads).unwrap().1);
        assert_eq!(text("nonsense"), None);
        assert_eq!(text(""), None);
    }

    #[test]
    fn text_of_the_second_version_is_understood() {
        let crs = |kind: &str, cs: &str, unit: &str| {
            format!(
                r#"{kind}["WGS 84",ENSEMBLE["World Geodetic System 1984",MEMBER["a"],ELLIPSOID["WGS 84",6378137,298.257223563,LENGTHUNIT["metre",1]]],PRIMEM["Greenwich",0,ANGLEUNIT["degree",0.0174532925199433]],CS[{cs}],AXIS["latitude",north,ORDER[1],{unit}],AXIS["longitude",east,ORDER[2],{unit}],ID["EPSG",4979]]"#
            )
        };
        let degree = r#"ANGLEUNIT["degree",0.0174532925199433]"#;
        for kind in ["GEOGCRS", "GEODCRS", "GEODETICCRS", "geogcrs"] {
            assert!(text(&crs(kind, "ellipsoidal,3", degree)).unwrap().1, "{kind}");
        }
        let metre = r#"LENGTHUNIT["metre",1]"#;
        assert_eq!(text(&crs("GEODCRS", "Cartesian,3", metre)), None, "geocentric");
        let compound = format!(
            r#"COMPOUNDCRS["both",{},VERTCRS["h",VDATUM["d"],CS[vertical,1],AXIS["up",up,LENGTHUNIT["metre",1]]]]"#,
            crs("GEOGCRS", "ellipsoidal,2", degree)
        );
        assert_eq!(text(&compound).unwrap(), ("WGS 84".to_owned(), true, None));
        let projected = format!(
            r#"PROJCRS["x",BASEGEOGCRS["y",DATUM["z",ELLIPSOID["e",1,2]]],CONVERSION["c"],CS[Cartesian,2],{metre}]"#
        );
        assert_eq!(text(&projected), None);
        let bound = format!(
            r#"BOUNDCRS[SOURCECRS[{}],TARGETCRS[{}]]"#,
            projected,
            crs("GEOGCRS", "ellipsoidal,2", degree)
        );
        assert_eq!(text(&bound), None);
    }
}
