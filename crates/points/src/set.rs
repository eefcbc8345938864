//! A point file's contents, as read.

/// Positions and attributes of one point file, in the file's own coordinates.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PointSet {
    /// Finite positions.
    pub positions: Vec<[f64; 3]>,
    /// Place in the file of each.
    pub file_index: Vec<u32>,
    /// Linear RGB.
    pub colors: Option<Vec<[f32; 3]>>,
}
