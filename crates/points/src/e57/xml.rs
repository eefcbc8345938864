//! What the description says of each scan.

use super::Fault;
use crate::field::Type;
use crate::sensor::Pose;
use roxmltree::{Document, Node, ParsingOptions};

/// Most elements of a description, and most numbers of a point.
const MAX_NODES: u32 = 1 << 20;
const MAX_COLUMNS: usize = 1 << 12;

/// A scan.
pub(super) struct Scan {
    /// Physical place of its points, and how many they are.
    pub(super) place: u64,
    pub(super) count: u64,
    pub(super) columns: Vec<Column>,
    pub(super) pose: Pose,
    /// Whether the file states it.
    pub(super) is_posed: bool,
    /// Lowest and highest of each colour, where the scan says so.
    pub(super) color_limits: [Option<[f64; 2]>; 3],
}

impl Scan {
    pub(super) fn record_bits(&self) -> u64 {
        self.columns.iter().map(|column| u64::from(column.codec.bits())).sum()
    }

    /// The column of this name.
    pub(super) fn find(&self, name: &str) -> Option<usize> {
        self.columns.iter().position(|column| column.name == name)
    }
}

/// One number of each point.
pub(super) struct Column {
    /// Without the prefix of an extension.
    pub(super) name: String,
    pub(super) codec: Codec,
}

/// How a number is stored.
#[derive(Clone, Copy)]
pub(super) enum Codec {
    Single,
    Double,
    /// What is over the lowest, in as many bits as the highest needs.
    Integer {
        min: i64,
        max: i64,
    },
    Scaled {
        min: i64,
        max: i64,
        scale: f64,
        offset: f64,
    },
}

impl Codec {
    /// Bits of a number.
    pub(super) fn bits(self) -> u32 {
        match self {
            Self::Single => 32,
            Self::Double => 64,
            Self::Integer { min, max } | Self::Scaled { min, max, .. } => {
                let span = max.wrapping_sub(min) as u64;
                u64::BITS - span.leading_zeros()
            }
        }
    }

    /// The number that bits stand for.
    pub(super) fn value(self, bits: u64) -> f64 {
        match self {
            Self::Single => f32::from_bits(bits as u32).into(),
            Self::Double => f64::from_bits(bits),
            Self::Integer { min, .. } => min.wrapping_add(bits as i64) as f64,
            Self::Scaled { min, scale, offset, .. } => {
                min.wrapping_add(bits as i64) as f64 * scale + offset
            }
        }
    }

    /// The smallest type that holds every number.
    pub(super) fn held(self) -> Type {
        match self {
            Self::Single => Type::F32,
            Self::Double | Self::Scaled { .. } => Type::F64,
            Self::Integer { min, max } => {
                let fits = |kind: &Type| {
                    let (low, high) = kind.limits();
                    min as f64 >= low && max as f64 <= high
                };
                let types = [Type::U8, Type::I8, Type::U16, Type::I16, Type::U32, Type::I32];
                types.into_iter().find(fits).unwrap_or(Type::F64)
            }
        }
    }

    /// Lowest and highest number, of integers.
    pub(super) fn limits(self) -> Option<[f64; 2]> {
        match self {
            Self::Integer { min, max } => Some([min as f64, max as f64]),
            Self::Scaled { min, max, scale, offset } => {
                Some([min as f64 * scale + offset, max as f64 * scale + offset])
            }
            Self::Single | Self::Double => None,
        }
    }
}

/// All scans of a description.
pub(super) fn scans(text: &str) -> Result<Vec<Scan>, Fault> {
    let options = ParsingOptions { nodes_limit: MAX_NODES, ..ParsingOptions::default() };
    let document = Document::parse_with_options(text, options)
        .map_err(|error| Fault::wrong("the XML section", error, "XML"))?;
    let data = child(document.root_element(), "data3D");
    let children = data.iter().flat_map(|data| data.children());
    let nodes: Vec<Node<'_, '_>> =
        children.filter(|node| node.is_element() && child(*node, "points").is_some()).collect();
    if nodes.is_empty() {
        return Err(Fault::NoScans);
    }
    nodes.into_iter().enumerate().map(|(index, node)| scan(index, node)).collect()
}

fn scan(index: usize, node: Node<'_, '_>) -> Result<Scan, Fault> {
    let of_scan = |what: &str| format!("{what} of scan {index}");
    let points = child(node, "points").unwrap_or(node);
    let attribute = |name: &str| -> Result<u64, Fault> {
        let text = points.attribute(name).unwrap_or("none");
        text.trim().parse().map_err(|_| Fault::wrong(of_scan(name), text, "a number"))
    };
    let prototype = child(points, "prototype")
        .ok_or_else(|| Fault::wrong(of_scan("points"), "no prototype", "one"))?;
    let columns: Vec<Column> = prototype
        .children()
        .filter(Node::is_element)
        .map(|node| column(index, node))
        .collect::<Result<_, _>>()?;
    if columns.len() > MAX_COLUMNS {
        let expected = format!("at most {MAX_COLUMNS}");
        return Err(Fault::unread(of_scan("numbers in the prototype"), columns.len(), expected));
    }
    let codecs =
        child(points, "codecs").iter().any(|codecs| codecs.children().any(|n| n.is_element()));
    let packed_otherwise = codecs
        && points.descendants().any(|node| {
            node.is_element()
                && node.tag_name().name().ends_with("Codec")
                && node.tag_name().name() != "bitPackCodec"
        });
    if packed_otherwise {
        return Err(Fault::unread(of_scan("codecs"), "another codec", "bitPackCodec"));
    }

    let limits = child(node, "colorLimits");
    let color_limits = ["Red", "Green", "Blue"].map(|name| {
        let end = |end: &str| number(child(limits?, &format!("color{name}{end}"))?);
        Some([end("Minimum")?, end("Maximum")?])
    });
    let scan = Scan {
        place: attribute("fileOffset")?,
        count: attribute("recordCount")?,
        columns,
        pose: pose(node),
        is_posed: child(node, "pose").is_some(),
        color_limits,
    };
    if scan.record_bits() == 0 && scan.count > 0 {
        let found = format!("{} points without a bit", scan.count);
        return Err(Fault::wrong(of_scan("the prototype"), found, "numbers that are stored"));
    }
    Ok(scan)
}

fn column(index: usize, node: Node<'_, '_>) -> Result<Column, Fault> {
    let name = node.tag_name().name().to_owned();
    let place = |what: &str| format!("{what} of '{name}' in the prototype of scan {index}");
    let integer = |key: &str, absent: i64| match node.attribute(key) {
        None => Ok(absent),
        Some(text) => text
            .trim()
            .parse::<i64>()
            .map_err(|_| Fault::wrong(place(key), text, "an integer of 64 bits")),
    };
    let float = |key: &str, absent: f64| match node.attribute(key) {
        None => Ok(absent),
        Some(text) => {
            text.trim().parse::<f64>().map_err(|_| Fault::wrong(place(key), text, "a number"))
        }
    };
    let codec = match node.attribute("type") {
        Some("Float") if node.attribute("precision") == Some("single") => Codec::Single,
        Some("Float") => Codec::Double,
        Some(kind @ ("Integer" | "ScaledInteger")) => {
            let (min, max) = (integer("minimum", i64::MIN)?, integer("maximum", i64::MAX)?);
            if min > max {
                let expected = format!("at least the minimum, {min}");
                return Err(Fault::wrong(place("the maximum"), max, expected));
            }
            match kind {
                "Integer" => Codec::Integer { min, max },
                _ => {
                    let (scale, offset) = (float("scale", 1.0)?, float("offset", 0.0)?);
                    Codec::Scaled { min, max, scale, offset }
                }
            }
        }
        other => {
            let found = other.unwrap_or("none");
            return Err(Fault::unread(place("the type"), found, "Float, Integer or ScaledInteger"));
        }
    };
    Ok(Column { name, codec })
}

/// How a scan is turned and moved; without a pose, not at all.
fn pose(scan: Node<'_, '_>) -> Pose {
    let pose = child(scan, "pose");
    let part = |name: &str| pose.and_then(|pose| child(pose, name));
    let of = |part: Option<Node<'_, '_>>, name: &str, absent: f64| {
        part.and_then(|part| child(part, name)).and_then(number).unwrap_or(absent)
    };
    let rotation = part("rotation");
    let q = [("w", 1.0), ("x", 0.0), ("y", 0.0), ("z", 0.0)];
    let turned = Pose::of_quaternion(q.map(|(name, absent)| of(rotation, name, absent)), [0.0; 3]);
    let translation = part("translation");
    let translation = ["x", "y", "z"].map(|axis| of(translation, axis, 0.0));
    Pose { translation, ..turned.unwrap_or(Pose::IDENTITY) }
}

/// The element of this name in another, whatever its namespace.
fn child<'a, 'd>(node: Node<'a, 'd>, name: &str) -> Option<Node<'a, 'd>> {
    node.children().find(|child| child.is_element() && child.tag_name().name() == name)
}

fn number(node: Node<'_, '_>) -> Option<f64> {
    // An element without text is 0.
    node.text().map_or(Some(0.0), |text| text.trim().parse().ok())
}
