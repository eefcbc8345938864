//! Points block by block, so that no more than a few blocks of a file are held.
//!
//! [`in_blocks`] reads a file of any format as [`read_with`](crate::read_with) does, but whenever a
//! block is full, the collector hands it over to another thread, which looks at it while the next is
//! read.

use crate::error::PointsError;
use crate::options::ReadOptions;
use crate::set::{Attribute, PointSet, Values, each_type};
use std::fmt;
use std::sync::mpsc::{Receiver, SyncSender, channel, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};

/// Points of a block at most.
pub(crate) const BLOCK_POINTS: usize = 1 << 14;
/// Bytes of a block, about.
const BLOCK_BYTES: usize = 1 << 22;
/// Blocks that wait to be looked at.
const WAITING: usize = 2;

/// Where points go instead of into the set that a reader returns.
///
/// Colours go there as the numbers of the file: what they mean is known only at its end.
#[derive(Clone)]
pub struct Outlet {
    full: SyncSender<Option<PointSet>>,
    /// Blocks that were looked at, to be filled again.
    empty: Arc<Mutex<Receiver<PointSet>>>,
}

impl Outlet {
    /// Hands over the points of a set, and leaves it without, ready for more of the same kind.
    pub(crate) fn take(&self, set: &mut PointSet) {
        let empty = self.empty.lock().unwrap_or_else(PoisonError::into_inner).try_recv();
        let mut block = empty.unwrap_or_default();
        let fits = block.attributes.len() == set.attributes.len()
            && block.colors.is_some() == set.colors.is_some()
            && block.normals.is_some() == set.normals.is_some();
        if fits {
            block.clear();
        } else {
            block = without_points(set);
        }
        std::mem::swap(&mut block.positions, &mut set.positions);
        std::mem::swap(&mut block.file_index, &mut set.file_index);
        std::mem::swap(&mut block.colors, &mut set.colors);
        std::mem::swap(&mut block.normals, &mut set.normals);
        std::mem::swap(&mut block.attributes, &mut set.attributes);
        self.send(Some(block));
    }

    /// Hands over normals that come apart from their points.
    pub(crate) fn take_normals(&self, normals: Vec<[f32; 3]>) {
        self.send(Some(PointSet { normals: Some(normals), ..PointSet::default() }));
    }

    /// What went there is void: the reader goes back to the beginning.
    pub(crate) fn begin_again(&self) {
        self.send(None);
    }

    fn send(&self, block: Option<PointSet>) {
        // Fails only if the other thread panicked, which `in_blocks` hands on.
        let _ = self.full.send(block);
    }

    /// Points of a block in which each has the lists of this set.
    pub(crate) fn block_of(set: &PointSet) -> usize {
        let colors = if set.colors.is_some() { 12 } else { 0 };
        let normals = if set.normals.is_some() { 12 } else { 0 };
        let values: usize = set.attributes.iter().map(|of| of.values.size()).sum();
        (BLOCK_BYTES / (28 + colors + normals + values)).clamp(1, BLOCK_POINTS)
    }
}

impl fmt::Debug for Outlet {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Outlet")
    }
}

/// The same outlet, that is.
impl PartialEq for Outlet {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.empty, &other.empty)
    }
}

fn without_points(set: &PointSet) -> PointSet {
    let attributes = set.attributes.iter().map(|attribute| Attribute {
        name: attribute.name.clone(),
        values: attribute.values.none(),
    });
    PointSet {
        colors: set.colors.is_some().then(Vec::new),
        normals: set.normals.is_some().then(Vec::new),
        attributes: attributes.collect(),
        ..PointSet::default()
    }
}

/// Reads with `read`, to which the options to be used are given, and shows `take` every block in turn, or `None`
/// where the reader begins again; a block that it gives back is filled again. What is returned has no points, but all else that is known after them.
pub(crate) fn in_blocks(
    options: &ReadOptions,
    read: impl FnOnce(&ReadOptions) -> Result<PointSet, PointsError>,
    take: impl FnMut(Option<PointSet>) -> Option<PointSet> + Send,
) -> Result<PointSet, PointsError> {
    let (full, blocks) = sync_channel(WAITING);
    let (back, empty) = channel();
    let mut take = take;
    std::thread::scope(|scope| {
        let looking = scope.spawn(move || {
            for block in blocks {
                if let Some(block) = take(block) {
                    // Fails only if reading has ended.
                    let _ = back.send(block);
                }
            }
        });
        let outlet = Outlet { full, empty: Arc::new(Mutex::new(empty)) };
        let options = ReadOptions { outlet: Some(outlet), ..options.clone() };
        let set = read(&options);
        // Closes the way for blocks, which ends the other thread.
        drop(options);
        if let Err(panic) = looking.join() {
            std::panic::resume_unwind(panic);
        }
        set
    })
}

impl PointSet {
    /// Forgets the points.
    fn clear(&mut self) {
        self.positions.clear();
        self.file_index.clear();
        self.colors.iter_mut().for_each(Vec::clear);
        self.normals.iter_mut().for_each(Vec::clear);
        self.attributes.iter_mut().for_each(|attribute| attribute.values.clear());
    }

    /// Bytes of the points.
    pub(crate) fn bytes(&self) -> usize {
        let values = self.attributes.iter().map(|of| of.values.len() * of.values.size());
        28 * self.positions.len()
            + 12 * self.colors.as_ref().map_or(0, Vec::len)
            + 12 * self.normals.as_ref().map_or(0, Vec::len)
            + values.sum::<usize>()
    }
}

impl Values {
    /// No values of the same type.
    fn none(&self) -> Self {
        match self {
            Self::I8(_) => Self::I8(Vec::new()),
            Self::U8(_) => Self::U8(Vec::new()),
            Self::I16(_) => Self::I16(Vec::new()),
            Self::U16(_) => Self::U16(Vec::new()),
            Self::I32(_) => Self::I32(Vec::new()),
            Self::U32(_) => Self::U32(Vec::new()),
            Self::F32(_) => Self::F32(Vec::new()),
            Self::F64(_) => Self::F64(Vec::new()),
        }
    }

    fn clear(&mut self) {
        each_type!(self, list => list.clear());
    }

    /// Bytes of a value.
    fn size(&self) -> usize {
        match self {
            Self::I8(_) | Self::U8(_) => 1,
            Self::I16(_) | Self::U16(_) => 2,
            Self::I32(_) | Self::U32(_) | Self::F32(_) => 4,
            Self::F64(_) => 8,
        }
    }
}
